#include "ferrers/math/traced.h"

#include <cmath>
#include <span>

#include "ferrers/core/checks.h"

namespace ferrers {
namespace {

thread_local Trace* current_trace = nullptr;

bool is_number(const Traced& a, double value) { return a.is_constant() && a.constant() == value; }

}  // namespace

Trace::Trace() {
  require(current_trace == nullptr, "Trace: another one lives in this thread");
  current_trace = this;
}

Trace::~Trace() { current_trace = nullptr; }

Trace& Trace::current() {
  require(current_trace != nullptr, "Trace: none lives in this thread");
  return *current_trace;
}

Traced Trace::input(int index) { return {graph_.input(index), nullptr}; }

int Trace::value_of(const Traced& number) {
  return number.is_constant() ? graph_.constant(number.constant()) : number.value_;
}

Traced Trace::operation(ExpressionOp op, const Traced& a, const Traced& b) {
  const bool has_two = op >= ExpressionOp::kAdd && op <= ExpressionOp::kPower;
  const int first = value_of(a), second = has_two || op == ExpressionOp::kAtan2 ? value_of(b) : -1;
  return {graph_.operation(op, first, second, -1), nullptr};
}

Traced traced_operation(ExpressionOp op, const Traced& a, const Traced& b) {
  if (a.is_constant() && b.is_constant()) return apply_expression_op(op, a.constant(), b.constant(), 0);
  return Trace::current().operation(op, a, b);
}

Traced operator-(const Traced& a) { return traced_operation(ExpressionOp::kNegate, a, 0.0); }

Traced operator+(const Traced& a, const Traced& b) {
  if (a.is_zero()) return b;
  if (b.is_zero()) return a;
  return traced_operation(ExpressionOp::kAdd, a, b);
}

Traced operator-(const Traced& a, const Traced& b) {
  if (a.is_zero()) return -b;
  if (b.is_zero()) return a;
  if (!a.is_constant() && a.value_ == b.value_) return 0.0;
  return traced_operation(ExpressionOp::kSubtract, a, b);
}

Traced operator*(const Traced& a, const Traced& b) {
  if (a.is_zero() || b.is_zero()) return 0.0;
  if (is_number(a, 1)) return b;
  if (is_number(b, 1)) return a;
  if (is_number(a, -1)) return -b;
  if (is_number(b, -1)) return -a;
  return traced_operation(ExpressionOp::kMultiply, a, b);
}

Traced operator/(const Traced& a, const Traced& b) {
  if (a.is_zero()) return 0.0;
  if (is_number(b, 1)) return a;
  return traced_operation(ExpressionOp::kDivide, a, b);
}

Traced& Traced::operator+=(const Traced& o) { return *this = *this + o; }
Traced& Traced::operator-=(const Traced& o) { return *this = *this - o; }
Traced& Traced::operator*=(const Traced& o) { return *this = *this * o; }
Traced& Traced::operator/=(const Traced& o) { return *this = *this / o; }

namespace {

// Σ c_k zᵏ.
Traced polynomial(std::span<const double> c, const Traced& z) {
  Traced sum = c.back();
  for (std::size_t k = c.size() - 1; k-- > 0;) sum = sum * z + Traced(c[k]);
  return sum;
}

// The angle is k quarter turns and r, |r| ≤ π/4. A quarter turn is written as three numbers, of which the first two
// have 33 digits, so that their products with k are exact. The polynomials of z = r² interpolate (sin r − r)/r³ and
// (cos r − 1 + r²/2)/r⁴ at Chebyshev's points, which leaves 1.4e-17 and 9e-19 of sine and cosine.
struct SineCosine {
  Traced sine, cosine;

  explicit SineCosine(const Traced& angle) {
    static constexpr double kSine[] = {-0.16666666666666666,  0.008333333333330946,    -0.0001984126983675497,
                                       2.755731610068303e-06, -2.5051131455427946e-08, 1.591810123027412e-10};
    static constexpr double kCosine[] = {0.041666666666666664,    -0.0013888888888887395, 2.4801587298763433e-05,
                                         -2.7557317270560326e-07, 2.0876146024689747e-09, -1.1382614868556325e-11};
    const Traced k = floor(angle * Traced(0.63661977236758134) + Traced(0.5));
    const Traced r =
        ((angle - k * Traced(0x1.921fb544p+0)) - k * Traced(0x1.0b4611a6p-34)) - k * Traced(0x1.3198a2e037073p-69);
    const Traced z = r * r;
    const Traced s = r + r * z * polynomial(kSine, z);
    const Traced c = Traced(1.0) - z * (Traced(0.5) - z * polynomial(kCosine, z));
    const Traced half = floor(k * Traced(0.5)), odd = k - half * Traced(2.0);
    const Traced sign = Traced(1.0) - Traced(2.0) * (half - Traced(2.0) * floor(half * Traced(0.5)));
    const Traced turned = sign * odd, straight = sign - turned;  // one of them is 0
    sine = s * straight + c * turned;
    cosine = c * straight - s * turned;
  }
};

}  // namespace

Traced sin(const Traced& a) { return a.is_constant() ? Traced(std::sin(a.constant())) : SineCosine(a).sine; }
Traced cos(const Traced& a) { return a.is_constant() ? Traced(std::cos(a.constant())) : SineCosine(a).cosine; }
Traced acos(const Traced& a) { return traced_operation(ExpressionOp::kAcos, a, 0.0); }
Traced sqrt(const Traced& a) { return traced_operation(ExpressionOp::kSqrt, a, 0.0); }
Traced floor(const Traced& a) { return traced_operation(ExpressionOp::kFloor, a, 0.0); }
Traced round(const Traced& a) { return floor(a + 0.5); }
Traced atan2(const Traced& a, const Traced& b) { return traced_operation(ExpressionOp::kAtan2, a, b); }

}  // namespace ferrers
