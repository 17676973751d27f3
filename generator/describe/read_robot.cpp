// SPDX-License-Identifier: GPL-2.0-or-later
#include "describe/read_robot.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "describe/identifiers.hpp"
#include "describe/mjcf_elements.hpp"
#include "describe/read_bytes.hpp"
#include "describe/robot_tree.hpp"
#include "describe/sdf_elements.hpp"
#include "describe/sha256.hpp"
#include "describe/urdf_elements.hpp"

namespace anholon {
namespace {

bool is_zero(const RobotInertial& inertial) {
  return inertial.mass.is_zero() &&
         std::ranges::all_of(inertial.inertia, [](const Exact& x) { return x.is_zero(); });
}

RobotFile read_elements(const XmlSource& source, RobotFormat format, bool snap) {
  switch (format) {
    case RobotFormat::urdf:
      return read_urdf_elements(source, snap);
    case RobotFormat::sdf:
      return read_sdf_elements(source, snap);
    case RobotFormat::mjcf:
      return read_mjcf_elements(source, snap);
  }
  return {};
}

RobotFormat format_of(const XmlSource& source) {
  const std::string_view name = source.root().Name();
  if (name == "robot") return RobotFormat::urdf;
  if (name == "sdf") return RobotFormat::sdf;
  if (name == "mujoco") return RobotFormat::mjcf;
  throw ModelError(source.place(source.root()), fmt::format("the outermost element is <{}>", name),
                   "a robot file is one <robot> (URDF), <sdf> (SDFormat) or <mujoco> (MJCF)");
}

/// The links and joints of a file as a model.
class RobotBuilder {
 public:
  /// @param whole_file  as a place
  RobotBuilder(RobotFile file, const Location& whole_file, const RobotOptions& options,
               const RobotSupplement& supplement)
      : options_(options),
        supplement_(supplement),
        whole_file_(whole_file),
        file_(std::move(file)),
        tree_(robot_tree(file_, whole_file)) {
    model_.parameters = supplement.parameters;
  }

  Model run() {
    model_.notes = file_.notes;
    model_.title = file_.name;
    model_.name = NameGiver("robot", model_.notes)(file_.name);
    model_.group = options_.floating || file_.base == RobotBase::free ? GroupKind::SE3 : GroupKind::fixed;
    read_gravity();
    drop_world();
    name_coordinates();
    leave_out_coupled();
    model_.coordinates.insert(model_.coordinates.end(), supplement_.coordinates.begin(),
                              supplement_.coordinates.end());
    read_inertias();
    make_inputs();
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) add_link(n);
    return std::move(model_);
  }

 private:
  Expr constant(const Exact& x) { return {*model_.tape, model_.tape->constant(x)}; }
  [[nodiscard]] const RobotLink& link(std::size_t node) const {
    return file_.links[static_cast<std::size_t>(tree_.nodes[node].link)];
  }
  [[nodiscard]] const RobotJoint& joint(int j) const { return file_.joints[static_cast<std::size_t>(j)]; }
  void note(std::string text) { model_.notes.push_back(std::move(text)); }

  void read_gravity() {
    const ExactVector standard = {0, 0, -Exact::from_decimal("9.81")};
    const ExactVector g =
        options_.gravity ? ExactVector{0, 0, -*options_.gravity} : file_.gravity.value_or(standard);
    for (std::size_t i = 0; i < 3; ++i) model_.gravity[i] = constant(g[i]);
  }

  /// A massless root whose only joint is a floating one is the world itself.
  void drop_world() {
    if (!root_is_free()) {
      if (options_.floating && file_.base == RobotBase::fixed)
        throw ModelError(whole_file_,
                         "--floating is asked for, and the file joins the robot to the world itself",
                         "leave out --floating, or give the file a free root");
      return;
    }
    const RobotJoint& first = joint(tree_.nodes[1].joint);
    note(fmt::format(
        "assumed: floating joint '{}': link '{}' is the reference body and moves in SE(3); '{}' is the world",
        first.name, link(1).name, link(0).name));
    model_.group = GroupKind::SE3;
    tree_.nodes.erase(tree_.nodes.begin());
    for (RobotNode& node : tree_.nodes) --node.parent;
    tree_.nodes[0] = {tree_.nodes[0].link, -1, -1};
  }

  [[nodiscard]] bool root_is_free() const {
    if (tree_.nodes.size() < 2) return false;
    const auto& inertial = link(0).inertial;
    return joint(tree_.nodes[1].joint).type == RobotJointType::floating &&
           std::ranges::count(tree_.nodes, 0, &RobotNode::parent) == 1 && (!inertial || is_zero(*inertial));
  }

  /// One coordinate for each displacement of a joint that does not mimic.
  void name_coordinates() {
    NameGiver name("joint", model_.notes);
    first_coordinate_.assign(file_.joints.size(), -1);
    const auto add = [&](const RobotJoint& j, const std::string& text, bool is_angle, bool is_chain) {
      Coordinate c;
      c.name = name(text);
      c.drive = Drive::active;
      c.is_angle = is_angle;
      c.upper = is_angle ? Exact::pi() : Exact(1);
      c.lower = -c.upper;
      c.where = j.where;
      if (j.limit && !is_chain) c.lower = (*j.limit)[0], c.upper = (*j.limit)[1];
      if (!j.limit && j.type == RobotJointType::revolute)
        note(fmt::format("assumed: joint '{}' has no limits: range [-pi, pi]", j.name));
      if (!is_angle && (is_chain || !j.limit))
        note(fmt::format("assumed: joint '{}' has no limits along {}: range [-1, 1] m", j.name, c.name));
      model_.coordinates.push_back(std::move(c));
    };
    for (const RobotNode& node : tree_.nodes) {
      if (node.joint < 0) continue;
      const auto j = static_cast<std::size_t>(node.joint);
      const RobotJoint& described = file_.joints[j];
      if (described.mimic || described.type == RobotJointType::fixed) continue;
      first_coordinate_[j] = static_cast<int>(model_.coordinates.size());
      if (described.type == RobotJointType::planar) {
        for (const char* part : {"x", "y"})
          add(described, fmt::format("{}_{}", described.name, part), false, true);
        add(described, described.name + "_angle", true, true);
      } else if (described.type == RobotJointType::floating) {
        for (const char* part : {"x", "y", "z"})
          add(described, fmt::format("{}_{}", described.name, part), false, true);
        for (const char* part : {"yaw", "pitch", "roll"})
          add(described, fmt::format("{}_{}", described.name, part), true, true);
        note(fmt::format(
            "assumed: floating joint '{}' inside the tree became three slides and three turns (yaw, "
            "pitch, roll): singular "
            "at a pitch of pi/2",
            described.name));
      } else {
        add(described, described.name, described.type != RobotJointType::prismatic, false);
      }
    }
  }

  /// Coordinates that a supplement couples go; their joints keep the names and await a displacement.
  void leave_out_coupled() {
    std::vector<int> place(model_.coordinates.size(), -1);
    std::vector<Coordinate> kept;
    for (std::size_t i = 0; i < place.size(); ++i) {
      coordinate_names_.push_back(model_.coordinates[i].name);
      if (std::ranges::find(supplement_.coupled, coordinate_names_[i]) != supplement_.coupled.end()) continue;
      place[i] = static_cast<int>(kept.size());
      kept.push_back(model_.coordinates[i]);
    }
    model_.coordinates = std::move(kept);
    places_ = std::move(place);
  }

  /// Mass, first moment and inertia of every link about its own origin, in its own axes; parameters where
  /// wanted.
  void read_inertias() {
    NameGiver body_name("link", model_.notes);
    for (std::size_t n = 0; n < tree_.nodes.size(); ++n) {
      names_.push_back(body_name(link(n).name));
      std::array<Exact, 10> figures;  // m, mx, my, mz, xx, yy, zz, xy, xz, yz
      const auto& inertial = link(n).inertial;
      if (!inertial) {
        if (!link(n).is_frame)
          note(fmt::format("assumed: link '{}' has no inertial: massless", link(n).name));
      } else {
        figures = about_origin(*inertial, link(n).name);
      }
      figures_.push_back(figures);
      if (!options_.symbolic_inertia) continue;
      name_armature(n);
      constexpr std::array<const char*, 10> suffix = {"m",   "mx",  "my",  "mz",  "Ixx",
                                                      "Iyy", "Izz", "Ixy", "Ixz", "Iyz"};
      std::array<std::size_t, 10>& index = parameter_of_.emplace_back();
      for (std::size_t i = 0; i < 10; ++i) {
        if (figures[i].is_zero()) continue;
        index[i] = model_.parameters.size();
        for (std::size_t j = 4; j < i && i < 7; ++j) {  // a symmetric body stays one, as a zero stays zero
          if (figures[j] == figures[i]) index[i] = index[j];
        }
        if (index[i] < model_.parameters.size()) continue;
        const char* unit = i == 0 ? "kg" : i < 4 ? "kg m" : "kg m^2";
        model_.parameters.push_back(
            {fmt::format("{}{}{}", names_[n], names_[n].back() == '_' ? "" : "_", suffix[i]), figures[i],
             unit, fmt::format("{} of link {} about its origin, in its own axes", suffix[i], link(n).name),
             inertial->where});
      }
    }
  }

  /// The armature of the joint that carries a link, as a parameter.
  void name_armature(std::size_t n) {
    armature_of_.push_back(model_.parameters.size());
    if (tree_.nodes[n].joint < 0 || joint(tree_.nodes[n].joint).armature.is_zero()) return;
    const RobotJoint& j = joint(tree_.nodes[n].joint);
    model_.parameters.push_back({fmt::format("{}{}armature", names_[n], names_[n].back() == '_' ? "" : "_"),
                                 j.armature, j.type == RobotJointType::prismatic ? "kg" : "kg m^2",
                                 fmt::format("armature of joint {}", j.name), j.where});
  }

  std::array<Exact, 10> about_origin(const RobotInertial& i, const std::string& name) {
    const std::string what = fmt::format("the inertial of link '{}'", name);
    const ExactMatrix& R = i.pose.R;
    const ExactMatrix central = {i.inertia[0], i.inertia[3], i.inertia[4], i.inertia[3], i.inertia[1],
                                 i.inertia[5], i.inertia[4], i.inertia[5], i.inertia[2]};
    const ExactVector& c = i.pose.p;
    const Exact half_trace = (central[0] + central[4] + central[8]) / Exact(2);
    for (std::size_t k = 0; k < 3; ++k) {
      if (half_trace - central[4 * k] < -half_trace * Exact::from_decimal("1e-9")) {
        note(fmt::format(
            "doubtful: {} breaks the triangle rule: one principal moment exceeds the sum of the others",
            what));
        break;
      }
    }
    // a product with the identity would keep the values but not their exactness as zeros
    const bool turned = R != identity_matrix();
    const ExactMatrix I = turned ? product(product(R, central), transposed(R)) : central;
    const Exact& m = i.mass;
    const Exact square = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
    if (m.is_zero() && !is_zero(i)) note(fmt::format("doubtful: link '{}' has inertia but no mass", name));
    return {m,
            m * c[0],
            m * c[1],
            m * c[2],
            I[0] + m * (square - c[0] * c[0]),
            I[4] + m * (square - c[1] * c[1]),
            I[8] + m * (square - c[2] * c[2]),
            I[1] - m * c[0] * c[1],
            I[2] - m * c[0] * c[2],
            I[5] - m * c[1] * c[2]};
  }

  /// The inputs of the model's tape, in the order that all models have.
  void make_inputs() {
    Tape& tape = *model_.tape;
    StateSymbols& s = model_.symbols;
    constexpr std::array<char, 3> axes = {'X', 'Y', 'Z'};
    for (const Parameter& p : model_.parameters) s.parameters.push_back(tape.input(p.name));
    s.t = tape.input("t");
    for (std::size_t i = 0; i < 9; ++i) s.R[i] = tape.input(fmt::format("R_{}{}", axes[i / 3], axes[i % 3]));
    for (std::size_t i = 0; i < 3; ++i) s.p[i] = tape.input(fmt::format("p_{}", axes[i]));
    for (const Coordinate& c : model_.coordinates) s.r.push_back(tape.input(c.name));
    for (std::size_t i = 0; i < 6; ++i) s.eta[i] = tape.input(std::string(twist_component_names[i]));
    for (const Coordinate& c : model_.coordinates) s.r_dot.push_back(tape.input(c.name + "_dot"));
  }

  void add_link(std::size_t n) {
    BodyDescription body;
    body.name = names_[n];
    body.where = link(n).where;
    set_inertia(body, n);
    const RobotNode& node = tree_.nodes[n];
    if (node.joint < 0) {
      body_of_.push_back(static_cast<int>(model_.bodies.size()));
      model_.bodies.push_back(std::move(body));
      return;
    }
    const RobotJoint& j = joint(node.joint);
    body.parent = body_of_[static_cast<std::size_t>(node.parent)];
    for (std::size_t i = 0; i < 9; ++i) body.R[i] = constant(j.pose.R[i]);
    for (std::size_t i = 0; i < 3; ++i) body.p[i] = constant(j.pose.p[i]);
    if (j.type == RobotJointType::planar || j.type == RobotJointType::floating) {
      add_chain(std::move(body), j, node.joint);
    } else {
      if (j.type != RobotJointType::fixed) add_joint(body, j, node.joint);
      if (!j.armature.is_zero())
        body.joint.armature = options_.symbolic_inertia
                                  ? Expr(*model_.tape, model_.symbols.parameters[armature_of_[n]])
                                  : constant(j.armature);
      model_.bodies.push_back(std::move(body));
    }
    body_of_.push_back(static_cast<int>(model_.bodies.size()) - 1);
  }

  void set_inertia(BodyDescription& body, std::size_t n) {
    std::array<Expr, 10> f;
    for (std::size_t i = 0; i < 10; ++i) {
      f[i] = figures_[n][i].is_zero()    ? Expr(0)
             : options_.symbolic_inertia ? Expr(*model_.tape, model_.symbols.parameters[parameter_of_[n][i]])
                                         : constant(figures_[n][i]);
    }
    body.mass = f[0];
    body.first_moment = {f[1], f[2], f[3]};
    body.inertia = {f[4], f[5], f[6], f[7], f[8], f[9]};
  }

  std::array<Expr, 3> axis(const RobotJoint& j) {
    const ExactVector a = unit_vector(j.axis, !options_.as_written);
    if (a != j.axis)
      note(fmt::format("snapped: axis of joint '{}' taken as ({}, {}, {})", j.name, a[0].decimal(8),
                       a[1].decimal(8), a[2].decimal(8)));
    return {constant(a[0]), constant(a[1]), constant(a[2])};
  }

  void add_joint(BodyDescription& body, const RobotJoint& j, int index) {
    const RobotFollower& follower = tree_.followers[static_cast<std::size_t>(index)];
    const auto number =
        static_cast<std::size_t>(first_coordinate_[static_cast<std::size_t>(follower.leader)]);
    body.joint.kind = j.type == RobotJointType::prismatic ? JointKind::prismatic : JointKind::revolute;
    body.joint.axis = axis(j);
    body.joint.coordinate = coordinate_names_[number];
    if (places_[number] < 0) {
      if (j.mimic || !j.damping.is_zero() || !j.friction.is_zero() || !j.stiffness.is_zero())
        throw ModelError(j.where,
                         fmt::format("joint '{}' {}, and '{}' is coupled by a supplement", j.name,
                                     j.mimic ? "mimics another" : "has damping, friction or a spring",
                                     coordinate_names_[number]),
                         "say it in the supplement instead, as a coupling, damping, friction or stiffness");
      return;
    }
    const auto coordinate = static_cast<std::size_t>(places_[number]);
    const Expr factor = constant(follower.multiplier);
    const Expr turned = factor * Expr(*model_.tape, model_.symbols.r[coordinate]);
    body.joint.displacement = turned + constant(follower.offset);
    if (!j.stiffness.is_zero()) {
      const Expr stretch = turned + constant(follower.offset - j.rest);
      const Expr square = stretch * stretch;
      model_.potential += constant(j.stiffness / Exact(2)) * square;
    }
    const Expr rate = factor * Expr(*model_.tape, model_.symbols.r_dot[coordinate]);
    add_resistance(j, coordinate, factor, rate);
  }

  /// Damping c: D = c/2 rate^2; dry friction: -f sign(rate).
  void add_resistance(const RobotJoint& j, std::size_t coordinate, const Expr& factor, const Expr& rate) {
    if (!j.damping.is_zero()) {
      const Expr square = rate * rate;
      model_.dissipation += constant(j.damping / Exact(2)) * square;
    }
    if (!j.friction.is_zero()) {
      const Expr effort = constant(-j.friction) * sign(rate);
      model_.forces.push_back({static_cast<int>(6 + coordinate), factor * effort});
    }
  }

  /// A joint of several displacements as a chain of massless bodies; the link is the last of them.
  void add_chain(BodyDescription body, const RobotJoint& j, int index) {
    const bool planar = j.type == RobotJointType::planar;
    std::vector<std::pair<JointKind, std::array<Expr, 3>>> steps;
    if (planar) {
      const ExactVector normal = unit_vector(j.axis, !options_.as_written);
      std::size_t least =
          0;  // the coordinate axis that is least along the normal: the next two make a right-handed frame
      for (std::size_t k = 1; k < 3; ++k) {
        if (abs(normal[k]) < abs(normal[least])) least = k;
      }
      ExactVector x;
      for (std::size_t k = 0; k < 3; ++k)
        x[k] = (k == least ? Exact(1) : Exact(0)) - normal[least] * normal[k];
      x = unit_vector(x, true);
      const ExactVector y = {normal[1] * x[2] - normal[2] * x[1], normal[2] * x[0] - normal[0] * x[2],
                             normal[0] * x[1] - normal[1] * x[0]};
      for (const ExactVector& a : {x, y})
        steps.emplace_back(JointKind::prismatic, std::array{constant(a[0]), constant(a[1]), constant(a[2])});
      steps.emplace_back(JointKind::revolute, axis(j));
    } else {
      const std::array<std::array<Expr, 3>, 3> e = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
      for (std::size_t k = 0; k < 3; ++k) steps.emplace_back(JointKind::prismatic, e[k]);
      for (std::size_t k = 3; k-- > 0;) steps.emplace_back(JointKind::revolute, e[k]);
    }
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const int place =
          places_[static_cast<std::size_t>(first_coordinate_[static_cast<std::size_t>(index)]) + i];
      if (place < 0)
        throw ModelError(j.where,
                         fmt::format("joint '{}' has several coordinates, one of them coupled", j.name),
                         "couple revolute, continuous and prismatic joints only");
      const auto coordinate = static_cast<std::size_t>(place);
      BodyDescription part;
      const bool last = i + 1 == steps.size();
      if (last) part = body;
      part.name = last ? body.name : fmt::format("{}_{}", body.name, i + 1);
      part.where = body.where;
      part.parent = i == 0 ? body.parent : static_cast<int>(model_.bodies.size()) - 1;
      part.R = i == 0 ? body.R : BodyDescription().R;
      part.p = i == 0 ? body.p : BodyDescription().p;
      part.joint.kind = steps[i].first;
      part.joint.axis = steps[i].second;
      part.joint.coordinate = model_.coordinates[coordinate].name;
      part.joint.displacement = Expr(*model_.tape, model_.symbols.r[coordinate]);
      add_resistance(j, coordinate, 1, Expr(*model_.tape, model_.symbols.r_dot[coordinate]));
      model_.bodies.push_back(std::move(part));
    }
  }

  const RobotOptions options_;
  const RobotSupplement& supplement_;
  Location whole_file_;
  RobotFile file_;
  RobotTree tree_;
  Model model_;
  std::vector<int> first_coordinate_;           // of each joint, in Model::coordinates
  std::vector<std::string> coordinate_names_;   // of all coordinates that the file has
  std::vector<int> places_;                     // of those in Model::coordinates; -1: left out
  std::vector<std::string> names_;              // of the nodes' links
  std::vector<std::array<Exact, 10>> figures_;  // inertial figures of the nodes' links
  std::vector<int> body_of_;                    // of each node, in Model::bodies
  std::vector<std::size_t> armature_of_;        // parameter of each node, where inertia is symbolic
  std::vector<std::array<std::size_t, 10>> parameter_of_;  // where inertia is symbolic
};

Model read_text(std::string_view text, const std::string& file_name, const RobotOptions& options,
                const RobotSupplement& supplement, std::optional<RobotFormat> expected) {
  const XmlSource source(text, file_name);
  const RobotFormat format = format_of(source);
  if (expected && format != *expected)
    throw ModelError(source.place(source.root()),
                     fmt::format("the file is of the format {}, not {}", name_of(format), name_of(*expected)),
                     "name it by the key of its format: urdf, sdf or mjcf");
  Model model =
      RobotBuilder(read_elements(source, format, !options.as_written), {file_name, 0, 0}, options, supplement)
          .run();
  model.file = std::filesystem::path(file_name).filename().string();
  model.sha256 = sha256_of(text);
  return model;
}

}  // namespace

std::string_view name_of(RobotFormat format) {
  constexpr std::array<std::string_view, 3> names = {"URDF", "SDFormat", "MJCF"};
  return names[static_cast<std::size_t>(format)];
}

bool is_robot_file(const std::filesystem::path& path) {
  const std::array<std::string_view, 4> endings = {".urdf", ".sdf", ".mjcf", ".xml"};
  return std::ranges::find(endings, path.extension().string()) != endings.end();
}

Model read_robot_text(std::string_view text, const std::string& file_name, const RobotOptions& options,
                      const RobotSupplement& supplement) {
  return read_text(text, file_name, options, supplement, std::nullopt);
}

Model read_robot(const std::filesystem::path& path, const RobotOptions& options,
                 const RobotSupplement& supplement, std::optional<RobotFormat> expected) {
  return read_text(read_bytes(path), path.string(), options, supplement, expected);
}

}  // namespace anholon
