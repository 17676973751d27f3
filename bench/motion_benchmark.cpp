// SPDX-License-Identifier: GPL-2.0-or-later

// Error against processor time of a whole motion: a robot falls freely for a second from its first sample, or
// the rigid snake-board goes through its gait. Generated code in double and in float and the project's
// recursion, all in Dormand-Prince 5(4), beside MuJoCo's and Simbody's own integrators, each along its ladder
// until the error no longer falls. The reference is Gauss collocation of order 12 in long double, for a fall
// on the recursion. Prints Markdown.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "anholon/articulated.hpp"
#include "anholon/integrate/dopri.hpp"
#include "anholon/lie/se3.hpp"
#include "anholon/lie/trivial.hpp"
#include "check/compile_cache.hpp"
#include "contenders.hpp"
#include "derive/tree_functions.hpp"
#include "emit/write_file.hpp"
#include "motion.hpp"
#include "report/motion_json.hpp"
#include "report/page.hpp"
#include "report/record.hpp"
#include "simulate/cpu_time.hpp"
#include "simulate/gauss_collocation.hpp"
#include "snakeboard_motion.hpp"

namespace {

using namespace anholon;
using namespace anholon::bench;
using nlohmann::ordered_json;

template <class S>
using Vector = Eigen::Matrix<S, Eigen::Dynamic, 1>;
template <class G>
using Point = integrate::State<G>;

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

/// y = (r, r_dot), or (r, eta, r_dot) where the base is free, by articulated bodies.
template <class S, class G>
class RecursionField {
 public:
  explicit RecursionField(const Mechanism<double>& mechanism)
      : mechanism_(converted<S>(mechanism)),
        tree_(mechanism_),
        r_(static_cast<std::size_t>(mechanism.coordinates)),
        r_dot_(r_),
        zeros_(r_.size(), S(0)) {}

  void operator()(S, const G& g, const Vector<S>& y, typename G::Tangent& eta, Vector<S>& y_dot) {
    const auto n = static_cast<Eigen::Index>(r_.size());
    for (Eigen::Index i = 0; i < n; ++i)
      r_[static_cast<std::size_t>(i)] = y[i], r_dot_[static_cast<std::size_t>(i)] = y[n + G::dim + i];
    tree_.position(r_);
    y_dot.head(n) = y.tail(n);
    if constexpr (G::dim == 0) {
      tree_.move_base({}, {}, -mechanism_.gravity);
      tree_.move(r_dot_, zeros_);
      const TreeAcceleration<S> a = articulated_acceleration(tree_, zeros_);
      for (Eigen::Index i = 0; i < n; ++i) y_dot[n + i] = a.r_ddot[static_cast<std::size_t>(i)];
    } else {  // the base's acceleration minus gravity is an unknown
      eta = y.segment(n, G::dim);
      const Vec3<S> V{eta[0], eta[1], eta[2]}, Omega{eta[3], eta[4], eta[5]};
      Mat3<S> R;
      for (int i = 0; i < 9; ++i) R.m[static_cast<std::size_t>(i)] = g.R()(i / 3, i % 3);
      tree_.move_base(Omega, {}, {});
      tree_.move(r_dot_, zeros_);
      TreeAcceleration<S> a = articulated_acceleration(tree_, zeros_);
      a.base.linear -= cross(Omega, V) - transposed_times(R, mechanism_.gravity);
      for (int i = 0; i < G::dim; ++i) y_dot[n + i] = a.base[i];
      for (Eigen::Index i = 0; i < n; ++i) y_dot[n + G::dim + i] = a.r_ddot[static_cast<std::size_t>(i)];
    }
  }

 private:
  Mechanism<S> mechanism_;
  RigidTree<S> tree_;
  std::vector<S> r_, r_dot_, zeros_;
};

/// The same by the generated forward dynamics.
template <class G>
class GeneratedField {
 public:
  GeneratedField(const Robot& robot, AbiScalar scalar)
      : derivation_(derive_tree(robot.model, {.functions = {"forward_dynamics"}})),
        code_(std::make_unique<CompiledProgram>(derivation_->program, options(scalar))),
        function_(&code_->function("forward_dynamics")),
        zeros_(robot.model.coordinates.size(), 0.0) {
    const auto n = static_cast<Eigen::Index>(zeros_.size());
    inputs_.resize(static_cast<std::size_t>(function_->input_count));
    for (std::size_t i = 0; i < inputs_.size(); ++i) {
      const std::string name = function_->inputs[i].name;
      inputs_[i] = name == "R" ? R_.data() : zeros_.data();
      if (name == "r") of_y_.emplace_back(i, 0);
      if (name == "eta") of_y_.emplace_back(i, n);
      if (name == "r_dot") of_y_.emplace_back(i, n + G::dim);
    }
  }
  GeneratedField(const GeneratedField&) = delete;  // inputs are places of this one
  GeneratedField& operator=(const GeneratedField&) = delete;
  void operator()(double, const G& g, const Vector<double>& y, typename G::Tangent& eta,
                  Vector<double>& y_dot) {
    const auto n = static_cast<Eigen::Index>(zeros_.size());
    if constexpr (G::dim > 0) {
      const auto rotation = g.R();
      for (int i = 0; i < 9; ++i) R_[static_cast<std::size_t>(i)] = rotation(i / 3, i % 3);
      eta = y.segment(n, G::dim);
    }
    for (const auto& [input, at] : of_y_) inputs_[input] = y.data() + at;
    y_dot.head(n) = y.tail(n);
    double* const outputs[] = {y_dot.data() + n, y_dot.data() + n + G::dim};  // a fixed base has no first
    code_->call(*function_, inputs_.data(), outputs);
  }

 private:
  static CompileOptions options(AbiScalar scalar) {
    CompileOptions options;
    options.scalar = scalar;
    return options;
  }
  std::unique_ptr<TreeDerivation> derivation_;
  std::unique_ptr<CompiledProgram> code_;
  const anholon_function* function_;
  std::vector<const double*> inputs_;
  std::vector<std::pair<std::size_t, Eigen::Index>>
      of_y_;  // inputs that are parts of y, and where these begin
  std::array<double, 9> R_{};
  std::vector<double> zeros_;
};

template <class G>
Point<G> start_of(const Robot& robot) {
  using S = typename G::Scalar;
  const Sample& sample = robot.samples.front();
  const State<double>& s = sample.state;
  const auto n = static_cast<Eigen::Index>(s.r.size());
  Point<G> point;
  point.y.resize(2 * n + G::dim);
  for (Eigen::Index i = 0; i < n; ++i)
    point.y[i] = S(s.r[static_cast<std::size_t>(i)]),
    point.y[n + G::dim + i] = S(s.r_dot[static_cast<std::size_t>(i)]);
  if constexpr (G::dim > 0) {
    const auto& q = sample.quaternion_wxyz;
    point.g = G(typename G::Vector4(S(q[0]), S(q[1]), S(q[2]), S(q[3])), G::Vector3::Zero());
    for (int i = 0; i < G::dim; ++i) point.y[n + i] = S(s.eta[i]);
  }
  return point;
}

template <class G>
FinalState end_of(const Point<G>& point) {
  FinalState end;
  const auto n = (point.y.size() - G::dim) / 2;
  const auto add = [](std::vector<double>& to, auto value) { to.push_back(static_cast<double>(value)); };
  if constexpr (G::dim > 0) {
    const auto R = point.g.R();
    const auto p = point.g.p();
    for (int i = 0; i < 9; ++i) add(end.position, R(i / 3, i % 3));
    for (int i = 0; i < 3; ++i) add(end.position, p[i]);
  }
  for (Eigen::Index i = 0; i < n; ++i) add(end.position, point.y[i]);
  for (Eigen::Index i = n; i < point.y.size(); ++i) add(end.velocity, point.y[i]);
  return end;
}

template <class G, class Field>
MotionRun by_dormand_prince(Field&& field, const Robot& robot, double duration, double tolerance) {
  Point<G> point = start_of<G>(robot);
  integrate::AdaptiveOptions<double> options;
  options.rtol = 0, options.atol = tolerance, options.max_steps = 10'000'000;
  integrate::DormandPrince<G> stages(point.y.size());
  MotionRun run;
  const double start = cpu_now();
  const auto result = integrate::integrate_adaptive(stages, field, point, duration, options);
  run.cpu_seconds = cpu_now() - start;
  run.evaluations = result.evaluations;
  run.status = integrate::name(result.status);
  run.end = end_of(point);
  return run;
}

struct Reference {
  FinalState end;
  double own_error = 0;  // how far half as many steps move it
};

/// Largest difference of positions, 1, rad or m, and of velocities relative to their largest component.
double distance(const FinalState& a, const FinalState& b) {
  double largest = 0, size = 0;
  const auto note = [&](double difference) {
    if (!(difference <= largest) && !std::isnan(largest)) largest = difference;  // keeps not-a-number
  };
  for (const double v : b.velocity) size = std::max(size, std::abs(v));
  for (std::size_t i = 0; i < b.position.size(); ++i) note(std::abs(a.position[i] - b.position[i]));
  for (std::size_t i = 0; i < b.velocity.size(); ++i) note(std::abs(a.velocity[i] - b.velocity[i]) / size);
  return largest;
}

template <class G>
Reference reference_of(const Robot& robot, double duration) {
  using S = typename G::Scalar;
  const auto end_after = [&](long steps) {
    Point<G> point = start_of<G>(robot);
    RecursionField<S, G> field(robot.mechanism);
    if (!integrate_gauss<6>(field, point, S(duration), steps))
      throw std::runtime_error("the reference did not converge");
    return end_of(point);
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

/// A run, repeated while it is too short for the clock; the least time counts.
ordered_json measured(const std::string& code, const char* rung, double setting, const Reference& reference,
                      const std::function<MotionRun()>& run) {
  double spent = 0, least = std::numeric_limits<double>::infinity();
  MotionRun once;
  for (int repeat = 0; repeat < 50 && (repeat < 3 || spent < 0.05); ++repeat) {
    once = run();
    spent += once.cpu_seconds;
    least = std::min(least, once.cpu_seconds);
  }
  const double error =
      once.status == "ok" ? distance(once.end, reference.end) : std::numeric_limits<double>::quiet_NaN();
  return {{"code", code},
          {rung, setting},
          {"error", finite_or_null(error)},
          {"cpu_seconds", least},
          {"evaluations", once.evaluations},
          {"status", once.status}};
}

/// One record of the report's kind (anholon.report.motion/1, "ladder"), of a fall.
template <template <class> class Group>
ordered_json fall(const Robot& robot, double duration) {
  using G = Group<double>;
  const Reference reference = reference_of<Group<long double>>(robot, duration);
  ordered_json points = ordered_json::array();
  const auto by_tolerance = [&](const std::string& code, int tightest,
                                const std::function<MotionRun(double)>& run) {
    for (int k = -3; k >= tightest; --k) {
      const double tolerance = std::pow(10.0, k);
      points.push_back(measured(code, "tolerance", tolerance, reference, [&] { return run(tolerance); }));
    }
  };
  GeneratedField<G> generated(robot, AbiScalar::is_double), single(robot, AbiScalar::is_float);
  RecursionField<double, G> recursion(robot.mechanism);
  by_tolerance("generated", -16,
               [&](double t) { return by_dormand_prince<G>(generated, robot, duration, t); });
  by_tolerance("generated, float", -9,
               [&](double t) { return by_dormand_prince<G>(single, robot, duration, t); });
  by_tolerance("recursion", -16,
               [&](double t) { return by_dormand_prince<G>(recursion, robot, duration, t); });
#ifdef ANHOLON_HAVE_SIMBODY
  by_tolerance("Simbody", -13, [&](double t) { return simbody_motion(robot, duration, t); });
#endif
  ordered_json record = {{"model", robot.name}, {"scene", "fall"}, {"duration_s", duration}};
#ifdef ANHOLON_HAVE_MUJOCO
  // It turns inertias to principal axes and so keeps nine digits of them: its errors are against its own
  // limit.
  constexpr long most_steps = 65536;
  const Reference limit{mujoco_motion(robot, duration, 2 * most_steps).end, 0};
  record["mujoco_limit"] = distance(limit.end, reference.end);
  for (long n = 64; n <= most_steps; n *= 2)
    points.push_back(measured("MuJoCo", "step", duration / static_cast<double>(n), limit,
                              [&] { return mujoco_motion(robot, duration, n); }));
#endif
  record["ladder"] = {{"reference", {{"own_error", reference.own_error}}}, {"points", points}};
  return record;
}

void print(const ordered_json& motion) {
  fmt::print("\n## {}, {}\n\nReference: half its steps move it by {:.1e}.\n",
             motion.at("model").get<std::string>(), motion.at("scene").get<std::string>(),
             motion.at("ladder").at("reference").at("own_error").get<double>());
  if (motion.contains("mujoco_limit"))
    fmt::print(
        "MuJoCo's inertias of nine digits move the end by {:.1e}; its errors are against its own limit.\n",
        motion.at("mujoco_limit").get<double>());
  std::vector<std::string> codes;
  for (const ordered_json& p : motion.at("ladder").at("points")) {
    const auto code = p.at("code").get<std::string>();
    if (std::ranges::find(codes, code) == codes.end()) codes.push_back(code);
  }
  for (const std::string& code : codes) {
    fmt::print(
        "\n{}:\n\n| tolerance or step | error | CPU time, s | evaluations |\n| --- | --- | --- | --- |\n",
        code);
    for (const ordered_json& p : motion.at("ladder").at("points")) {
      if (p.at("code") != code) continue;
      const bool ok = p.at("error").is_number();
      fmt::print("| {:.2g} | {} | {:.2e} | {} |\n",
                 (p.contains("step") ? p.at("step") : p.at("tolerance")).get<double>(),
                 ok ? fmt::format("{:.1e}", p.at("error").get<double>()) : p.at("status").get<std::string>(),
                 p.at("cpu_seconds").get<double>(), p.at("evaluations").get<long>());
    }
  }
  fmt::print("\n| CPU time for an error of | 1e-6 | 1e-9 |\n| --- | --- | --- |\n");
  for (const std::string& code : codes) {
    fmt::print("| {} |", code);
    for (const double error : {1e-6, 1e-9}) {
      const double seconds = cpu_seconds_at(motion, code, error);
      const double ratio = seconds / cpu_seconds_at(motion, "generated", error);
      fmt::print(" {} |",
                 std::isnan(seconds) ? "not reached" : fmt::format("{:.2e} s, {:.1f} times", seconds, ratio));
    }
    fmt::print("\n");
  }
  std::fflush(stdout);
}

ordered_json motion_of(const std::string& subject, double duration) {
  if (subject.ends_with(".scene.toml")) return snakeboard_motion(subject);
  const std::string suffix = ":floating";
  const bool is_free = subject.ends_with(suffix);
  const Robot robot =
      load_robot(subject.substr(0, subject.size() - (is_free ? suffix.size() : 0)), is_free, 1);
  return is_free ? fall<lie::SE3>(robot, duration) : fall<lie::Trivial>(robot, duration);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("error against processor time of whole motions, beside other engines", "motion_benchmark");
  double duration = 1;
  std::string json;
  std::vector<std::string> subjects;
  app.add_option("--duration", duration, "of a fall, s")->check(CLI::PositiveNumber);
  app.add_option("--json", json, "file for the same figures as numbers");
  app.add_option("SUBJECTS", subjects, "ROBOT.urdf, ROBOT.urdf:floating, rigid_snakeboard/gait.scene.toml")
      ->required();
  CLI11_PARSE(app, argc, argv);
  try {
    ordered_json record = {
        {"schema", "anholon.motions/1"}, {"machine", machine_record()}, {"motions", ordered_json::array()}};
    for (const std::string& subject : subjects) {
      record["motions"].push_back(motion_of(subject, duration));
      print(record["motions"].back());
    }
    if (!json.empty()) write_file(json, record.dump(1) + "\n");
  } catch (const std::exception& error) {
    fmt::print(stderr, "motion_benchmark: {}\n", error.what());
    return 1;
  }
  return 0;
}
