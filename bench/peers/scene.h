#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

/// What the programs of bench/peers share: the neutral scene, the clock, and the line that each prints.
///
/// Every program is called as `program scene.json SECONDS [SETTING=VALUE...]` and prints one JSON object with the CPU
/// time per evaluation (`us`, the least of many short batches, each going through all states), the largest relative
/// error of the joint accelerations over all states (`error`), the time to load (`load_s`) and the largest resident
/// set (`rss_kib`).
namespace peers {

using nlohmann::json;

inline constexpr int kGround = -1;

struct Body {
  std::string name;
  double mass = 0;
  double com[3] = {}, inertia[9] = {};
};

struct Joint {
  std::string name;
  bool revolute = true;
  int a = kGround, b = kGround;
  double at[3] = {}, axis[3] = {};
  double torque = 0, start_speed = 0;
};

struct Spring {
  int a = kGround, b = kGround;
  double on_a[3] = {}, on_b[3] = {};
  double stiffness = 0, free_length = 0;
};

/// A body that floats: the place of its mass centre, its turn (w, x, y, z), the mass centre's velocity, its spin.
struct FreeBody {
  int body = 0;
  double place[3] = {}, quaternion[4] = {}, velocity[3] = {}, spin[3] = {};
};

struct State {
  std::vector<double> q, v, a;  ///< Of every joint, also of those that close loops.
  std::vector<FreeBody> free;
};

struct Scene {
  std::string name, watched;
  double gravity[3] = {};
  std::vector<Body> bodies;
  std::vector<Joint> joints;
  std::vector<Spring> springs;
  std::vector<std::pair<int, int>> tree;  ///< Body and joint (-1: it floats), from ground outwards.
  std::vector<int> cut;                   ///< Joints that close loops.
  std::vector<State> states;

  int watched_joint() const {
    for (std::size_t i = 0; i < joints.size(); ++i) {
      if (joints[i].name == watched) return static_cast<int>(i);
    }
    return -1;
  }
};

template <std::size_t N>
void fill(const json& from, double (&to)[N]) {
  for (std::size_t i = 0; i < N; ++i) to[i] = from.at(i).get<double>();
}

inline State read_state(const json& from) {
  State s{from["q"].get<std::vector<double>>(),
          from["v"].get<std::vector<double>>(),
          from["a"].get<std::vector<double>>(),
          {}};
  for (const json& f : from["free"]) {
    FreeBody body;
    body.body = f["body"].get<int>();
    fill(f["place"], body.place);
    fill(f["quaternion"], body.quaternion);
    fill(f["velocity"], body.velocity);
    fill(f["spin"], body.spin);
    s.free.push_back(body);
  }
  return s;
}

inline Scene read_scene(const std::string& path) {
  std::ifstream file(path);
  const json from = json::parse(file);
  Scene s;
  s.name = from["name"].get<std::string>();
  s.watched = from["watched"].get<std::string>();
  fill(from["gravity"], s.gravity);
  for (const json& b : from["bodies"]) {
    s.bodies.push_back({b["name"].get<std::string>(), b["mass"].get<double>(), {}, {}});
    fill(b["com"], s.bodies.back().com);
    fill(b["inertia"], s.bodies.back().inertia);
  }
  for (const json& j : from["joints"]) {
    Joint joint;
    joint.name = j["name"].get<std::string>();
    joint.revolute = j["type"] == "revolute";
    joint.a = j["a"].get<int>();
    joint.b = j["b"].get<int>();
    fill(j["at"], joint.at);
    fill(j["axis"], joint.axis);
    joint.torque = j["torque"].get<double>();
    joint.start_speed = j["start_speed"].get<double>();
    s.joints.push_back(joint);
  }
  for (const json& p : from["springs"]) {
    Spring spring;
    spring.a = p["a"].get<int>();
    spring.b = p["b"].get<int>();
    fill(p["on_a"], spring.on_a);
    fill(p["on_b"], spring.on_b);
    spring.stiffness = p["stiffness"].get<double>();
    spring.free_length = p["free_length"].get<double>();
    s.springs.push_back(spring);
  }
  for (const json& t : from["tree"]) s.tree.emplace_back(t.at(0).get<int>(), t.at(1).get<int>());
  s.cut = from["cut"].get<std::vector<int>>();
  for (const json& state : from["states"]) s.states.push_back(read_state(state));
  return s;
}

/// CPU seconds of this process.
inline double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Least CPU time of `evaluate(state index)` in µs, all states in turn, over batches that last 2 ms or longer.
template <class Evaluate>
double least_microseconds(std::size_t states, double seconds, Evaluate&& evaluate) {
  const auto batch = [&](long rounds) {
    const double start = cpu_seconds();
    for (long r = 0; r < rounds; ++r) {
      for (std::size_t s = 0; s < states; ++s) evaluate(s);
    }
    return cpu_seconds() - start;
  };
  long rounds = 1;
  while (batch(rounds) < 2e-3 && rounds < (1L << 24)) rounds *= 2;
  double least = std::numeric_limits<double>::infinity();
  const double start = cpu_seconds();
  do least = std::min(least, batch(rounds));
  while (cpu_seconds() - start < seconds);
  return 1e6 * least / static_cast<double>(rounds) / static_cast<double>(states);
}

/// Largest difference of the accelerations that an engine tells (pairs of joint index and value), over their largest.
class ErrorMeter {
 public:
  void begin() { largest_ = difference_ = 0; }
  void add(double got, double exact) {
    largest_ = std::max(largest_, std::abs(exact));
    difference_ =
        std::isfinite(got) ? std::max(difference_, std::abs(got - exact)) : std::numeric_limits<double>::infinity();
  }
  void end() { worst_ = std::max(worst_, difference_ / largest_); }
  double worst() const { return worst_; }

 private:
  double largest_ = 0, difference_ = 0, worst_ = 0;
};

/// Of this program alone: what getrusage tells starts with the caller's.
inline long peak_rss_kib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmHWM:", 0) == 0) return std::stol(line.substr(6));
  }
  return 0;
}

inline void print(json out) {
  out["rss_kib"] = peak_rss_kib();
  std::printf("%s\n", out.dump().c_str());
}

/// `SETTING=VALUE` among the arguments, or the default.
inline std::string setting(int argc, char** argv, const std::string& name, const std::string& otherwise) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.rfind(name + "=", 0) == 0) return argument.substr(name.size() + 1);
  }
  return otherwise;
}

}  // namespace peers
