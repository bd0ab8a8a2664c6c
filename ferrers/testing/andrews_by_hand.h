#pragma once

#include <Eigen/Core>
#include <cmath>


/// Andrews' squeezer in its seven angles (beta, Theta, gamma, Phi, delta, Omega, epsilon) and six constraints, with
/// every derivative written by hand [schiehlen1990]: a witness for derivatives made by the engine, and what their speed
/// is measured against. Torque of 0.033 N·m on the crank included.
namespace ferrers::witness {

struct AndrewsByHand {
  using Vector7 = Eigen::Matrix<double, 7, 1>;
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  Eigen::Matrix<double, 7, 7, Eigen::RowMajor> M;
  Eigen::Matrix<double, 6, 7, Eigen::RowMajor> G;
  Vector7 force;  ///< tau − h.
  Vector6 phi, gamma;

  AndrewsByHand() {
    M.setZero();
    G.setZero();
  }

  void compute(const double* q, const double* v) {
    constexpr double xa = -0.06934, ya = -0.00227, xb = -0.03635, yb = 0.03273, xc = 0.014, yc = 0.072, rr = 0.007,
                     ra = 0.00092, d = 0.028, da = 0.0115, ss = 0.035, sa = 0.01874, sb = 0.01043, sc = 0.018,
                     sd = 0.02, e = 0.02, ea = 0.01421, zt = 0.04, ta = 0.02308, tb = 0.00916, zf = 0.02, fa = 0.01421,
                     u = 0.04, ua = 0.01228, ub = 0.00449, m1 = 0.04325, m2 = 0.00365, m3 = 0.02373, m4 = 0.00706,
                     m5 = 0.07050, m6 = 0.00706, m7 = 0.05498, I1 = 2.194e-6, I2 = 4.410e-7, I3 = 5.255e-6,
                     I4 = 5.667e-7, I5 = 1.169e-5, I6 = 5.667e-7, I7 = 1.912e-5, c0 = 4530, l0 = 0.07785,
                     torque = 0.033;
    const double sin_b = std::sin(q[0]), cos_b = std::cos(q[0]), sin_t = std::sin(q[1]), cos_t = std::cos(q[1]);
    const double sin_g = std::sin(q[2]), cos_g = std::cos(q[2]), sin_p = std::sin(q[3]), cos_p = std::cos(q[3]);
    const double sin_d = std::sin(q[4]), cos_d = std::cos(q[4]), sin_o = std::sin(q[5]), cos_o = std::cos(q[5]);
    const double sin_e = std::sin(q[6]), cos_e = std::cos(q[6]);
    const double sin_bt = std::sin(q[0] + q[1]), cos_bt = std::cos(q[0] + q[1]);
    const double sin_pd = std::sin(q[3] + q[4]), cos_pd = std::cos(q[3] + q[4]);
    const double sin_oe = std::sin(q[5] + q[6]), cos_oe = std::cos(q[5] + q[6]);
    const double bt = v[0] + v[1], pd = v[3] + v[4], oe = v[5] + v[6];

    M(0, 0) = m1 * ra * ra + m2 * (rr * rr - 2 * da * rr * cos_t + da * da) + I1 + I2;
    M(0, 1) = M(1, 0) = m2 * (da * da - da * rr * cos_t) + I2;
    M(1, 1) = m2 * da * da + I2;
    M(2, 2) = m3 * (sa * sa + sb * sb) + I3;
    M(3, 3) = m4 * (e - ea) * (e - ea) + I4;
    M(3, 4) = M(4, 3) = m4 * ((e - ea) * (e - ea) + zt * (e - ea) * sin_p) + I4;
    M(4, 4) = m4 * (zt * zt + 2 * zt * (e - ea) * sin_p + (e - ea) * (e - ea)) + m5 * (ta * ta + tb * tb) + I4 + I5;
    M(5, 5) = m6 * (zf - fa) * (zf - fa) + I6;
    M(5, 6) = M(6, 5) = m6 * ((zf - fa) * (zf - fa) - u * (zf - fa) * sin_o) + I6;
    M(6, 6) = m6 * ((zf - fa) * (zf - fa) - 2 * u * (zf - fa) * sin_o + u * u) + m7 * (ua * ua + ub * ub) + I6 + I7;

    const double dx = sd * cos_g + sc * sin_g + xb - xc, dy = sd * sin_g - sc * cos_g + yb - yc;
    const double length = std::sqrt(dx * dx + dy * dy), pull = -c0 * (length - l0) / length;
    force[0] = torque - m2 * da * rr * v[1] * (v[1] + 2 * v[0]) * sin_t;
    force[1] = m2 * da * rr * v[0] * v[0] * sin_t;
    force[2] = pull * (dx * (sc * cos_g - sd * sin_g) + dy * (sd * cos_g + sc * sin_g));
    force[3] = m4 * zt * (e - ea) * v[4] * v[4] * cos_p;
    force[4] = -m4 * zt * (e - ea) * v[3] * (v[3] + 2 * v[4]) * cos_p;
    force[5] = -m6 * u * (zf - fa) * v[6] * v[6] * cos_o;
    force[6] = m6 * u * (zf - fa) * v[5] * (v[5] + 2 * v[6]) * cos_o;

    const double x2 = rr * cos_b - d * cos_bt, y2 = rr * sin_b - d * sin_bt;
    phi[0] = x2 - ss * sin_g - xb;
    phi[1] = y2 + ss * cos_g - yb;
    phi[2] = x2 - e * sin_pd - zt * cos_d - xa;
    phi[3] = y2 + e * cos_pd - zt * sin_d - ya;
    phi[4] = x2 - zf * cos_oe - u * sin_e - xa;
    phi[5] = y2 - zf * sin_oe + u * cos_e - ya;
    for (int i = 0; i < 6; i += 2) {
      G(i, 0) = -y2;
      G(i, 1) = d * sin_bt;
      G(i + 1, 0) = x2;
      G(i + 1, 1) = -d * cos_bt;
    }
    G(0, 2) = -ss * cos_g;
    G(1, 2) = -ss * sin_g;
    G(2, 3) = -e * cos_pd;
    G(2, 4) = -e * cos_pd + zt * sin_d;
    G(3, 3) = -e * sin_pd;
    G(3, 4) = -e * sin_pd - zt * cos_d;
    G(4, 5) = zf * sin_oe;
    G(4, 6) = zf * sin_oe - u * cos_e;
    G(5, 5) = -zf * cos_oe;
    G(5, 6) = -zf * cos_oe - u * sin_e;

    const double ax = rr * cos_b * v[0] * v[0] - d * cos_bt * bt * bt;
    const double ay = rr * sin_b * v[0] * v[0] - d * sin_bt * bt * bt;
    gamma[0] = ax - ss * sin_g * v[2] * v[2];
    gamma[1] = ay + ss * cos_g * v[2] * v[2];
    gamma[2] = ax - e * sin_pd * pd * pd - zt * cos_d * v[4] * v[4];
    gamma[3] = ay + e * cos_pd * pd * pd - zt * sin_d * v[4] * v[4];
    gamma[4] = ax - zf * cos_oe * oe * oe - u * sin_e * v[6] * v[6];
    gamma[5] = ay - zf * sin_oe * oe * oe + u * cos_e * v[6] * v[6];
  }
};

}  // namespace ferrers::witness
