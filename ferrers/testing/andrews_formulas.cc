#include "ferrers/testing/andrews_formulas.h"

#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

namespace ferrers::witness {
namespace {

// [hairer1996, sec. VII.7]
constexpr double m1 = .04325, m2 = .00365, m3 = .02373, m4 = .00706, m5 = .07050, m6 = .00706, m7 = .05498;
constexpr double i1 = 2.194e-6, i2 = 4.410e-7, i3 = 5.255e-6, i4 = 5.667e-7, i5 = 1.169e-5, i6 = 5.667e-7,
                 i7 = 1.912e-5;
constexpr double xa = -.06934, ya = -.00227, xb = -.03635, yb = .03273, xc = .014, yc = .072;
constexpr double d = .028, da = .0115, e = .02, ea = .01421, rr = .007, ra = .00092, l0 = .07785, ss = .035,
                 sa = .01874, sb = .01043, sc = .018, sd = .02, ta = .02308, tb = .00916, u = .04, ua = .01228,
                 ub = .00449, zf = .02, zt = .04, fa = .01421, mom = .033, c0 = 4530;

constexpr std::pair<const char*, double> kNumbers[] = {
    {"m1", m1}, {"m2", m2}, {"m3", m3}, {"m4", m4}, {"m5", m5},   {"m6", m6}, {"m7", m7}, {"i1", i1}, {"i2", i2},
    {"i3", i3}, {"i4", i4}, {"i5", i5}, {"i6", i6}, {"i7", i7},   {"xa", xa}, {"ya", ya}, {"xb", xb}, {"yb", yb},
    {"xc", xc}, {"yc", yc}, {"d", d},   {"da", da}, {"e", e},     {"ea", ea}, {"rr", rr}, {"ra", ra}, {"l0", l0},
    {"ss", ss}, {"sa", sa}, {"sb", sb}, {"sc", sc}, {"sd", sd},   {"ta", ta}, {"tb", tb}, {"u", u},   {"ua", ua},
    {"ub", ub}, {"zf", zf}, {"zt", zt}, {"fa", fa}, {"mom", mom}, {"c0", c0}};

constexpr const char* kAngles[] = {"be", "th", "ga", "ph", "de", "om", "ep"};
constexpr const char* kRates[] = {"be_v", "th_v", "ga_v", "ph_v", "de_v", "om_v", "ep_v"};

constexpr const char* kEnergyInAngles =
    "(m1*ra^2 + i1)/2*be_v^2 + i2/2*(be_v + th_v)^2"
    " + m2/2*((da^2 - 2*da*rr*cos(th) + rr^2)*be_v^2 + 2*(da^2 - da*rr*cos(th))*be_v*th_v + da^2*th_v^2)"
    " + (m3*(sa^2 + sb^2) + i3)/2*ga_v^2"
    " + m4/2*((e - ea)^2*(ph_v + de_v)^2 + zt^2*de_v^2 + 2*zt*(e - ea)*sin(ph)*de_v*(ph_v + de_v))"
    " + i4/2*(ph_v + de_v)^2 + (m5*(ta^2 + tb^2) + i5)/2*de_v^2"
    " + m6/2*((zf - fa)^2*(om_v + ep_v)^2 + u^2*ep_v^2 - 2*u*(zf - fa)*sin(om)*ep_v*(om_v + ep_v))"
    " + i6/2*(om_v + ep_v)^2 + (m7*(ua^2 + ub^2) + i7)/2*ep_v^2";

struct Body {
  const char *mass, *inertia, *x, *y, *rate;
};
constexpr Body kBodies[] = {
    {"m1", "i1", "ra*cos(be)", "ra*sin(be)", "be_v"},
    {"m2", "i2", "rr*cos(be) - da*cos(be + th)", "rr*sin(be) - da*sin(be + th)", "be_v + th_v"},
    {"m3", "i3", "xb + sa*sin(ga) + sb*cos(ga)", "yb + sb*sin(ga) - sa*cos(ga)", "ga_v"},
    {"m4", "i4", "xa + zt*cos(de) + (e - ea)*sin(ph + de)", "ya + zt*sin(de) - (e - ea)*cos(ph + de)", "ph_v + de_v"},
    {"m5", "i5", "xa + ta*cos(de) - tb*sin(de)", "ya + ta*sin(de) + tb*cos(de)", "de_v"},
    {"m6", "i6", "xa + u*sin(ep) + (zf - fa)*cos(om + ep)", "ya - u*cos(ep) + (zf - fa)*sin(om + ep)", "om_v + ep_v"},
    {"m7", "i7", "xa + ua*sin(ep) - ub*cos(ep)", "ya - ua*cos(ep) - ub*sin(ep)", "ep_v"},
};

constexpr const char* kPotential =
    "c0/2*(hypot(xb + sc*sin(ga) + sd*cos(ga) - xc, yb + sd*sin(ga) - sc*cos(ga) - yc) - l0)^2 - mom*be";

constexpr const char* kConstraints[] = {
    "rr*cos(be) - d*cos(be + th) - ss*sin(ga) - xb",
    "rr*sin(be) - d*sin(be + th) + ss*cos(ga) - yb",
    "rr*cos(be) - d*cos(be + th) - e*sin(ph + de) - zt*cos(de) - xa",
    "rr*sin(be) - d*sin(be + th) + e*cos(ph + de) - zt*sin(de) - ya",
    "rr*cos(be) - d*cos(be + th) - zf*cos(om + ep) - u*sin(ep) - xa",
    "rr*sin(be) - d*sin(be + th) - zf*sin(om + ep) + u*cos(ep) - ya",
};

Expression formula(const char* text) {
  Diagnostics diagnostics;
  const std::optional<Expression> parsed = Expression::parse(text, {}, diagnostics);
  if (!parsed) throw std::logic_error(text);
  return parsed->substitute([](std::string_view name) -> std::optional<Expression> {
    for (const auto& [symbol, value] : kNumbers) {
      if (name == symbol) return Expression::constant(value);
    }
    return std::nullopt;
  });
}

/// d/dt at constant rates.
Expression rate_of(const Expression& quantity) {
  return quantity.rate([](std::string_view name) -> std::optional<Expression> {
    for (int j = 0; j < kAndrewsCoordinates; ++j) {
      if (name == kAngles[j]) return Expression::variable(kRates[j]);
    }
    return std::nullopt;
  });
}

Expression kinetic_energy(AndrewsEnergy energy) {
  if (energy == AndrewsEnergy::kAngles) return formula(kEnergyInAngles);
  const Expression half = Expression::constant(0.5);
  std::vector<Expression> terms;
  for (const Body& body : kBodies) {
    const Expression vx = rate_of(formula(body.x)), vy = rate_of(formula(body.y)), omega = formula(body.rate);
    terms.push_back(half * formula(body.mass) * (vx * vx + vy * vy));
    terms.push_back(half * formula(body.inertia) * omega * omega);
  }
  return sum_of(terms);
}

}  // namespace

std::vector<std::string> andrews_inputs() {
  std::vector<std::string> names(std::begin(kAngles), std::end(kAngles));
  names.insert(names.end(), std::begin(kRates), std::end(kRates));
  return names;
}

std::vector<Expression> andrews_formulas(AndrewsEnergy energy) {
  constexpr int n = kAndrewsCoordinates;
  const Expression T = kinetic_energy(energy), V = formula(kPotential);
  std::vector<Expression> momenta, outputs;
  for (const char* rate : kRates) momenta.push_back(T.derivative(rate));
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) outputs.push_back(momenta[i].derivative(kRates[j]));
  }
  for (int i = 0; i < n; ++i) {
    outputs.push_back(T.derivative(kAngles[i]) - V.derivative(kAngles[i]) - rate_of(momenta[i]));
  }
  std::vector<Expression> rows, jacobian, gamma;
  for (const char* constraint : kConstraints) {
    rows.push_back(formula(constraint));
    for (const char* angle : kAngles) jacobian.push_back(rows.back().derivative(angle));
    gamma.push_back(-rate_of(rate_of(rows.back())));
  }
  for (const auto& more : {rows, jacobian, gamma}) outputs.insert(outputs.end(), more.begin(), more.end());
  return outputs;
}

void compute_andrews_by_hand(const double* in, double* out) {
  const double be = in[0], th = in[1], ga = in[2], ph = in[3], de = in[4], om = in[5], ep = in[6];
  const double vbe = in[7], vth = in[8], vga = in[9], vph = in[10], vde = in[11], vom = in[12], vep = in[13];
  const double sibe = std::sin(be), cobe = std::cos(be), sith = std::sin(th), coth = std::cos(th);
  const double siga = std::sin(ga), coga = std::cos(ga), siph = std::sin(ph), coph = std::cos(ph);
  const double side = std::sin(de), code = std::cos(de), siom = std::sin(om), coom = std::cos(om);
  const double siep = std::sin(ep), coep = std::cos(ep);
  const double sibeth = std::sin(be + th), cobeth = std::cos(be + th);
  const double siphde = std::sin(ph + de), cophde = std::cos(ph + de);
  const double siomep = std::sin(om + ep), coomep = std::cos(om + ep);

  double* const M = out;
  for (int k = 0; k < 28; ++k) M[k] = 0;
  M[0] = m1 * ra * ra + m2 * (rr * rr - 2 * da * rr * coth + da * da) + i1 + i2;
  M[1] = m2 * (da * da - da * rr * coth) + i2;
  M[7] = m2 * da * da + i2;
  M[13] = m3 * (sa * sa + sb * sb) + i3;
  M[18] = m4 * (e - ea) * (e - ea) + i4;
  M[19] = m4 * ((e - ea) * (e - ea) + zt * (e - ea) * siph) + i4;
  M[22] = m4 * (zt * zt + 2 * zt * (e - ea) * siph + (e - ea) * (e - ea)) + m5 * (ta * ta + tb * tb) + i4 + i5;
  M[25] = m6 * (zf - fa) * (zf - fa) + i6;
  M[26] = m6 * ((zf - fa) * (zf - fa) - u * (zf - fa) * siom) + i6;
  M[27] = m6 * ((zf - fa) * (zf - fa) - 2 * u * (zf - fa) * siom + u * u) + m7 * (ua * ua + ub * ub) + i6 + i7;

  const double xd = sd * coga + sc * siga + xb, yd = sd * siga - sc * coga + yb;
  const double length = std::sqrt((xd - xc) * (xd - xc) + (yd - yc) * (yd - yc));
  const double force = -c0 * (length - l0) / length, fx = force * (xd - xc), fy = force * (yd - yc);
  double* const f = out + 28;
  f[0] = mom - m2 * da * rr * vth * (vth + 2 * vbe) * sith;
  f[1] = m2 * da * rr * vbe * vbe * sith;
  f[2] = fx * (sc * coga - sd * siga) + fy * (sd * coga + sc * siga);
  f[3] = m4 * zt * (e - ea) * vde * vde * coph;
  f[4] = -m4 * zt * (e - ea) * vph * (vph + 2 * vde) * coph;
  f[5] = -m6 * u * (zf - fa) * vep * vep * coom;
  f[6] = m6 * u * (zf - fa) * vom * (vom + 2 * vep) * coom;

  double* const phi = f + 7;
  phi[0] = rr * cobe - d * cobeth - ss * siga - xb;
  phi[1] = rr * sibe - d * sibeth + ss * coga - yb;
  phi[2] = rr * cobe - d * cobeth - e * siphde - zt * code - xa;
  phi[3] = rr * sibe - d * sibeth + e * cophde - zt * side - ya;
  phi[4] = rr * cobe - d * cobeth - zf * coomep - u * siep - xa;
  phi[5] = rr * sibe - d * sibeth - zf * siomep + u * coep - ya;

  double* const G = phi + 6;
  for (int k = 0; k < 42; ++k) G[k] = 0;
  for (int row = 0; row < 6; row += 2) {
    G[7 * row] = -rr * sibe + d * sibeth;
    G[7 * row + 1] = d * sibeth;
    G[7 * row + 7] = rr * cobe - d * cobeth;
    G[7 * row + 8] = -d * cobeth;
  }
  G[2] = -ss * coga;
  G[9] = -ss * siga;
  G[17] = -e * cophde;
  G[18] = -e * cophde + zt * side;
  G[24] = -e * siphde;
  G[25] = -e * siphde - zt * code;
  G[33] = zf * siomep;
  G[34] = zf * siomep - u * coep;
  G[40] = -zf * coomep;
  G[41] = -zf * coomep - u * siep;

  double* const gamma = G + 42;
  const double wbeth = (vbe + vth) * (vbe + vth), wphde = (vph + vde) * (vph + vde), womep = (vom + vep) * (vom + vep);
  gamma[0] = rr * cobe * vbe * vbe - d * cobeth * wbeth - ss * siga * vga * vga;
  gamma[1] = rr * sibe * vbe * vbe - d * sibeth * wbeth + ss * coga * vga * vga;
  gamma[2] = rr * cobe * vbe * vbe - d * cobeth * wbeth - e * siphde * wphde - zt * code * vde * vde;
  gamma[3] = rr * sibe * vbe * vbe - d * sibeth * wbeth + e * cophde * wphde - zt * side * vde * vde;
  gamma[4] = rr * cobe * vbe * vbe - d * cobeth * wbeth - zf * coomep * womep - u * siep * vep * vep;
  gamma[5] = rr * sibe * vbe * vbe - d * sibeth * wbeth - zf * siomep * womep + u * coep * vep * vep;
}

}  // namespace ferrers::witness
