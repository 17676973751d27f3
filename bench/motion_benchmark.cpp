// SPDX-License-Identifier: GPL-2.0-or-later

// Error against processor time of a whole motion: a robot on a fixed base falls freely for a second from its
// first sample. Generated code and the project's recursion in double, both in Dormand-Prince 5(4), beside
// MuJoCo's and Simbody's own integrators, each along its ladder until the error no longer falls. The
// reference is Gauss collocation of order 12 on the recursion in long double. Prints Markdown.
//
//   motion_benchmark [--duration SECONDS] URDF...

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "anholon/articulated.hpp"
#include "anholon/integrate/dopri.hpp"
#include "anholon/lie/trivial.hpp"
#include "check/compile_cache.hpp"
#include "contenders.hpp"
#include "derive/tree_functions.hpp"
#include "motion.hpp"
#include "simulate/cpu_time.hpp"
#include "simulate/gauss_collocation.hpp"

namespace {

using namespace anholon;
using namespace anholon::bench;

template <class S>
using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class S>
using Point = integrate::State<lie::Trivial<S>>;

/// The same numbers in another scalar.
template <class S>
Mechanism<S> converted(const Mechanism<double>& from) {
  const auto vector = [](const Vec3<double>& v) { return Vec3<S>{S(v.x), S(v.y), S(v.z)}; };
  const auto matrix = [](const Mat3<double>& m) {
    Mat3<S> r;
    for (std::size_t i = 0; i < 9; ++i) r.m[i] = S(m.m[i]);
    return r;
  };
  Mechanism<S> to;
  to.group = from.group, to.coordinates = from.coordinates, to.gravity = vector(from.gravity);
  for (const Body<double>& b : from.bodies) {
    Body<S>& c = to.bodies.emplace_back();
    c.name = b.name, c.parent = b.parent, c.kind = b.kind, c.axis = b.axis;
    c.coordinate = b.coordinate, c.coupling = b.coupling, c.pitch = S(b.pitch);
    c.R = matrix(b.R), c.p = vector(b.p), c.R_frame = matrix(b.R_frame);
    c.mass = S(b.mass), c.first_moment = vector(b.first_moment), c.inertia = matrix(b.inertia);
  }
  return to;
}

/// y = (r, r_dot), by articulated bodies.
template <class S>
class RecursionField {
 public:
  explicit RecursionField(const Mechanism<double>& mechanism)
      : mechanism_(converted<S>(mechanism)),
        tree_(mechanism_),
        r_(static_cast<std::size_t>(mechanism.coordinates)),
        r_dot_(r_),
        zeros_(r_.size(), S(0)) {}

  void operator()(S, const lie::Trivial<S>&, const Vector<S>& y, Eigen::Matrix<S, 0, 1>&, Vector<S>& y_dot) {
    const auto n = static_cast<Eigen::Index>(r_.size());
    for (Eigen::Index i = 0; i < n; ++i)
      r_[static_cast<std::size_t>(i)] = y[i], r_dot_[static_cast<std::size_t>(i)] = y[n + i];
    tree_.position(r_);
    tree_.move_base({}, {}, -mechanism_.gravity);
    tree_.move(r_dot_, zeros_);
    const TreeAcceleration<S> a = articulated_acceleration(tree_, zeros_);
    y_dot.head(n) = y.tail(n);
    for (Eigen::Index i = 0; i < n; ++i) y_dot[n + i] = a.r_ddot[static_cast<std::size_t>(i)];
  }

 private:
  Mechanism<S> mechanism_;
  RigidTree<S> tree_;
  std::vector<S> r_, r_dot_, zeros_;
};

/// y = (r, r_dot), by the generated forward dynamics.
class GeneratedField {
 public:
  explicit GeneratedField(const Robot& robot)
      : derivation_(derive_tree(robot.model, {.functions = {"forward_dynamics"}})),
        code_(std::make_unique<CompiledProgram>(derivation_->program, options())),
        function_(&code_->function("forward_dynamics")),
        zeros_(robot.model.coordinates.size(), 0.0) {
    for (int i = 0; i < function_->input_count; ++i) names_.emplace_back(function_->inputs[i].name);
    inputs_.resize(names_.size());
  }
  void operator()(double, const lie::Trivial<double>&, const Vector<double>& y, Eigen::Matrix<double, 0, 1>&,
                  Vector<double>& y_dot) {
    const auto n = static_cast<Eigen::Index>(zeros_.size());
    for (std::size_t i = 0; i < names_.size(); ++i)
      inputs_[i] = names_[i] == "r" ? y.data() : names_[i] == "r_dot" ? y.data() + n : zeros_.data();
    y_dot.head(n) = y.tail(n);
    double* const output = y_dot.data() + n;
    code_->call(*function_, inputs_.data(), &output);
  }

 private:
  static CompileOptions options() {
    CompileOptions options;
    options.flags = generated_flags();
    return options;
  }
  std::unique_ptr<TreeDerivation> derivation_;
  std::unique_ptr<CompiledProgram> code_;
  const anholon_function* function_;
  std::vector<std::string> names_;
  std::vector<const double*> inputs_;
  std::vector<double> zeros_;
};

template <class S>
Point<S> start_of(const Robot& robot) {
  const State<double>& s = robot.samples.front().state;
  const auto n = static_cast<Eigen::Index>(s.r.size());
  Point<S> point;
  point.y.resize(2 * n);
  for (Eigen::Index i = 0; i < n; ++i)
    point.y[i] = S(s.r[static_cast<std::size_t>(i)]),
    point.y[n + i] = S(s.r_dot[static_cast<std::size_t>(i)]);
  return point;
}

template <class Field>
MotionRun by_dormand_prince(Field&& field, const Robot& robot, double duration, double tolerance) {
  using G = lie::Trivial<double>;
  Point<double> point = start_of<double>(robot);
  integrate::AdaptiveOptions<double> options;
  options.rtol = 0, options.atol = tolerance, options.max_steps = 10'000'000;
  integrate::DormandPrince<G> stages(point.y.size());
  MotionRun run;
  const double start = cpu_now();
  const auto result = integrate::integrate_adaptive(stages, field, point, duration, options);
  run.cpu_seconds = cpu_now() - start;
  run.evaluations = result.evaluations;
  run.status = integrate::name(result.status);
  const auto n = point.y.size() / 2;
  run.end.r.assign(point.y.data(), point.y.data() + n);
  run.end.r_dot.assign(point.y.data() + n, point.y.data() + 2 * n);
  return run;
}

struct Reference {
  FinalState end;
  double own_error = 0;  // how far half as many steps move it
};

/// Largest difference of positions, rad, and of velocities relative to their largest component.
double distance(const FinalState& a, const FinalState& b) {
  double largest = 0, size = 0;
  for (const double v : b.r_dot) size = std::max(size, std::abs(v));
  for (std::size_t i = 0; i < b.r.size(); ++i) {
    const double difference = std::max(std::abs(a.r[i] - b.r[i]), std::abs(a.r_dot[i] - b.r_dot[i]) / size);
    if (!(difference <= largest)) largest = difference;
  }
  return largest;
}

Reference reference_of(const Robot& robot, double duration) {
  using S = long double;
  const auto end_after = [&](long steps) {
    Point<S> point = start_of<S>(robot);
    RecursionField<S> field(robot.mechanism);
    if (!integrate_gauss<6>(field, point, S(duration), steps))
      throw std::runtime_error("the reference did not converge");
    FinalState end;
    const auto n = point.y.size() / 2;
    for (Eigen::Index i = 0; i < n; ++i)
      end.r.push_back(static_cast<double>(point.y[i])),
          end.r_dot.push_back(static_cast<double>(point.y[n + i]));
    return end;
  };
  Reference reference;
  FinalState coarse = end_after(64);
  for (long steps = 128; steps <= 8192; steps *= 2) {
    reference.end = end_after(steps);
    reference.own_error = distance(coarse, reference.end);
    if (reference.own_error <= std::numeric_limits<double>::epsilon()) break;
    coarse = reference.end;
  }
  return reference;
}

struct Step {
  std::string setting;
  double error = 0, cpu_seconds = 0;
  long evaluations = 0;
};

/// Processor time that an error takes, by straight lines between the logarithms of the steps.
double seconds_at(const std::vector<Step>& ladder, double error) {
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    if (!(ladder[i].error <= error)) continue;
    if (i == 0) return ladder[0].cpu_seconds;
    const Step &a = ladder[i - 1], &b = ladder[i];
    const double part = std::log(error / a.error) / std::log(b.error / a.error);
    return a.cpu_seconds * std::pow(b.cpu_seconds / a.cpu_seconds, part);
  }
  return std::numeric_limits<double>::quiet_NaN();
}

/// A run, repeated while it is too short for the clock; the least time counts.
Step measured(const std::string& setting, const Reference& reference, const std::function<MotionRun()>& run) {
  Step step{setting, 0, std::numeric_limits<double>::infinity(), 0};
  double spent = 0;
  for (int repeat = 0; repeat < 50 && (repeat < 3 || spent < 0.05); ++repeat) {
    const MotionRun once = run();
    spent += once.cpu_seconds;
    step.cpu_seconds = std::min(step.cpu_seconds, once.cpu_seconds);
    step.evaluations = once.evaluations;
    step.error =
        once.status == "ok" ? distance(once.end, reference.end) : std::numeric_limits<double>::quiet_NaN();
  }
  return step;
}

void run_robot(const std::string& file, double duration) {
  const Robot robot = load_robot(file, false, 1);
  const Reference reference = reference_of(robot, duration);
  fmt::print("\n## {}\n\nReference: halving its steps moves it by {:.1e}.\n", robot.name,
             reference.own_error);
  std::vector<std::pair<std::string, std::vector<Step>>> ladders;
  const auto by_tolerance = [&](const std::string& name, int tightest,
                                const std::function<MotionRun(double)>& run) {
    auto& steps = ladders.emplace_back(name, std::vector<Step>{}).second;
    for (int k = -3; k >= tightest; --k) {
      const double tolerance = std::pow(10.0, k);
      steps.push_back(measured(fmt::format("{:.0e}", tolerance), reference, [&] { return run(tolerance); }));
    }
  };
  GeneratedField generated(robot);
  RecursionField<double> recursion(robot.mechanism);
  by_tolerance("generated, Dormand-Prince 5(4)", -16,
               [&](double t) { return by_dormand_prince(generated, robot, duration, t); });
  by_tolerance("recursion, Dormand-Prince 5(4)", -16,
               [&](double t) { return by_dormand_prince(recursion, robot, duration, t); });
#ifdef ANHOLON_HAVE_SIMBODY
  by_tolerance("Simbody, Runge-Kutta-Merson", -13,
               [&](double t) { return simbody_motion(robot, duration, t); });
#endif
#ifdef ANHOLON_HAVE_MUJOCO
  // It turns inertias to principal axes and so keeps nine digits of them: its errors are against its own
  // limit.
  constexpr long most_steps = 65536;
  const Reference limit{mujoco_motion(robot, duration, 2 * most_steps).end, 0};
  fmt::print(
      "MuJoCo's inertias of nine digits move the end by {:.1e}; its errors are against its own limit.\n",
      distance(limit.end, reference.end));
  auto& steps = ladders.emplace_back("MuJoCo, RK4", std::vector<Step>{}).second;
  for (long n = 64; n <= most_steps; n *= 2)
    steps.push_back(
        measured(fmt::format("{} steps", n), limit, [&] { return mujoco_motion(robot, duration, n); }));
#endif
  for (const auto& [name, ladder] : ladders) {
    fmt::print("\n{}:\n\n| setting | error | CPU time, s | evaluations |\n| --- | --- | --- | --- |\n", name);
    for (const Step& s : ladder)
      fmt::print("| {} | {:.1e} | {:.2e} | {} |\n", s.setting, s.error, s.cpu_seconds, s.evaluations);
  }
  fmt::print("\n| CPU time for an error of | 1e-6 | 1e-9 |\n| --- | --- | --- |\n");
  for (const auto& [name, ladder] : ladders) {
    fmt::print("| {} |", name);
    for (const double error : {1e-6, 1e-9}) {
      const double seconds = seconds_at(ladder, error);
      const double ratio = seconds / seconds_at(ladders.front().second, error);
      fmt::print(" {} |",
                 std::isnan(seconds) ? "not reached" : fmt::format("{:.2e} s, {:.1f} times", seconds, ratio));
    }
    fmt::print("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  double duration = 1;
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--duration") == 0 && i + 1 < argc) {
      const char* const end = argv[i + 1] + std::strlen(argv[i + 1]);
      if (std::from_chars(argv[++i], end, duration).ptr != end || !(duration > 0)) files.clear();
    } else {
      files.emplace_back(argv[i]);
    }
  }
  if (files.empty() || files.front().starts_with("--") || !(duration > 0)) {
    std::fputs("usage: motion_benchmark [--duration SECONDS] URDF...\n", stderr);
    return 2;
  }
  try {
    for (const std::string& file : files) run_robot(file, duration);
  } catch (const std::exception& error) {
    fmt::print(stderr, "motion_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
