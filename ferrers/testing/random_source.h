#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

namespace ferrers::witness {

/// Random numbers that are the same on every platform (the standard library's distributions are not): SplitMix64.
class RandomSource {
 public:
  explicit RandomSource(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    std::uint64_t x = (state_ += 0x9e3779b97f4a7c15u);
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }

  double between(double low, double high) { return low + (high - low) * static_cast<double>(next() >> 11) * 0x1p-53; }
  int below(int n) { return static_cast<int>(next() % static_cast<std::uint64_t>(n)); }
  bool chance(double probability) { return between(0, 1) < probability; }

  /// Entries in ±size.
  Eigen::Vector3d vector(double size) {
    const double x = between(-size, size), y = between(-size, size), z = between(-size, size);
    return {x, y, z};
  }

  /// Unit vector, uniform on the sphere.
  Eigen::Vector3d direction() {
    for (;;) {
      const Eigen::Vector3d v = vector(1);
      if (v.norm() > 0.1 && v.norm() <= 1) return v.normalized();
    }
  }

  Eigen::Matrix3d rotation() {
    const Eigen::Vector3d axis = direction();
    return Eigen::AngleAxisd(between(-3.1, 3.1), axis).toRotationMatrix();
  }

 private:
  std::uint64_t state_;
};

}  // namespace ferrers::witness
