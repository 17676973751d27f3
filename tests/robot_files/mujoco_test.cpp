// SPDX-License-Identifier: GPL-2.0-or-later

// MJCF files as MuJoCo reads them: its mass matrix and inverse dynamics at random states, springs and dampers
// included. It takes full inertias apart into principal axes, which leaves about nine digits; diagonal ones
// keep all.

#ifdef ANHOLON_HAVE_MUJOCO

#include <gtest/gtest.h>
#include <mujoco/mujoco.h>

#include <cstring>
#include <functional>
#include <memory>
#include <random>

#include "anholon/free_dynamics.hpp"
#include "describe/mechanise.hpp"
#include "describe/read_bytes.hpp"
#include "robot_files/same_robot.hpp"

namespace anholon::mujoco_test {
namespace {

struct Delete {
  void operator()(mjModel* m) const { mj_deleteModel(m); }
  void operator()(mjData* d) const { mj_deleteData(d); }
};

std::unique_ptr<mjModel, Delete> load(const std::string& xml) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size()));
  std::memcpy(files->filedata[0], xml.data(), xml.size());
  std::array<char, 1000> message{};
  std::unique_ptr<mjModel, Delete> model(
      mj_loadXML("robot.xml", files.get(), message.data(), static_cast<int>(message.size())));
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(message.data());
  model->opt.disableflags |= mjDSBL_CONSTRAINT;  // ranges and couplings
  return model;
}

/// Our velocities in MuJoCo's: eta in body axes, linear part first; there the linear part is in world axes.
class Twin {
 public:
  Twin(const std::string& xml, const Model& model)
      : mujoco_(load(xml)), data_(mj_makeData(mujoco_.get())), is_free_(model.group == GroupKind::SE3) {
    for (const Coordinate& c : model.coordinates) {
      const int joint = mj_name2id(mujoco_.get(), mjOBJ_JOINT, c.name.c_str());
      if (joint < 0) throw std::runtime_error("no joint " + c.name);
      position_.push_back(mujoco_->jnt_qposadr[joint]);
      velocity_.push_back(mujoco_->jnt_dofadr[joint]);
    }
  }

  /// Their inverse dynamics in our order. @param v_dot  (eta_dot, r_ddot)
  std::vector<double> inverse_dynamics(const State<double>& s, const std::vector<double>& v_dot) {
    set(s);
    std::fill(data_->qacc, data_->qacc + mujoco_->nv, 0.0);
    const std::size_t n = is_free_ ? 6 : 0;
    if (is_free_) {
      const Vec3<double> linear =
          s.R * (Vec3<double>{v_dot[0], v_dot[1], v_dot[2]} + cross(s.eta.angular, s.eta.linear));
      for (int c = 0; c < 3; ++c)
        data_->qacc[c] = linear[c], data_->qacc[3 + c] = v_dot[static_cast<std::size_t>(3 + c)];
    }
    for (std::size_t i = 0; i < velocity_.size(); ++i) data_->qacc[velocity_[i]] = v_dot[n + i];
    mj_inverse(mujoco_.get(), data_.get());
    return ours(s, data_->qfrc_inverse);
  }

  std::vector<std::vector<double>> mass_matrix(const State<double>& s) {
    set(s);
    mj_forward(mujoco_.get(), data_.get());
    const int n = mujoco_->nv;
    std::vector<double> full(static_cast<std::size_t>(n * n));
    mj_fullM(mujoco_.get(), full.data(), data_->qM);
    std::vector<std::vector<double>> half, columns;  // M in our order by rows, then by columns
    for (int i = 0; i < n; ++i) half.push_back(ours(s, full.data() + i * n));
    for (std::size_t j = 0; j < half[0].size(); ++j) {
      std::vector<double> column;
      for (const auto& row : half) column.push_back(row[j]);
      columns.push_back(ours(s, column.data()));
    }
    return columns;
  }

 private:
  void set(const State<double>& s) {
    if (is_free_) {
      const Vec3<double> v = s.R * s.eta.linear;
      for (int c = 0; c < 3; ++c) {
        data_->qpos[c] = s.p[c];
        data_->qvel[c] = v[c];
        data_->qvel[3 + c] = s.eta.angular[c];
      }
      mju_mat2Quat(data_->qpos + 3, s.R.m.data());
    }
    for (std::size_t i = 0; i < velocity_.size(); ++i) {
      data_->qpos[position_[i]] = s.r[i];
      data_->qvel[velocity_[i]] = s.r_dot[i];
    }
  }
  std::vector<double> ours(const State<double>& s, const double* v) const {
    std::vector<double> result;
    if (is_free_) {
      const Vec3<double> linear = transposed_times(s.R, Vec3<double>{v[0], v[1], v[2]});
      result = {linear.x, linear.y, linear.z, v[3], v[4], v[5]};
    }
    for (const int at : velocity_) result.push_back(v[at]);
    return result;
  }

  std::unique_ptr<mjModel, Delete> mujoco_;
  std::unique_ptr<mjData, Delete> data_;
  bool is_free_;
  std::vector<int> position_, velocity_;
};

Mat3<double> random_rotation(const std::function<double()>& random) {
  std::array<double, 4> q = {random(), random(), random(), random()};
  mju_normalize4(q.data());
  Mat3<double> R;
  mju_quat2Mat(R.m.data(), q.data());
  return R;
}

/// @param bound  on differences, relative to the largest entry
void compare(const std::string& xml, const Model& model, double bound) {
  const Mechanism<double> mechanism = mechanise<double>(describe_mechanism(model), {});
  FreeDynamics<double> dynamics(mechanism);
  Twin twin(xml, model);
  std::mt19937 generator(7);
  std::uniform_real_distribution<double> uniform(-2, 2);
  const std::function<double()> random = [&] { return uniform(generator); };
  const auto size = static_cast<std::size_t>(velocity_size(mechanism));
  double worst_force = 0, worst_mass = 0, worst_energy = 0;
  for (int trial = 0; trial < 20; ++trial) {
    State<double> s;
    if (model.group == GroupKind::SE3) {
      s.R = random_rotation(random);
      for (int i = 0; i < 3; ++i) s.p[i] = random(), s.eta.linear[i] = random(), s.eta.angular[i] = random();
    }
    std::vector<double> v_dot;
    for (std::size_t i = 0; i < model.coordinates.size(); ++i)
      s.r.push_back(random()), s.r_dot.push_back(random());
    for (std::size_t i = 0; i < size; ++i) v_dot.push_back(random());
    const auto compared = [](const auto& get, std::size_t count, double& worst) {
      double scale = 0, difference = 0;
      for (std::size_t i = 0; i < count; ++i) {
        const auto [a, b] = get(i);
        scale = std::max(scale, std::abs(b));
        difference = std::max(difference, std::abs(a - b));
      }
      worst = std::max(worst, difference / scale);
    };
    const std::vector<double> force = dynamics.inverse_dynamics(s, v_dot),
                              their_force = twin.inverse_dynamics(s, v_dot);
    compared([&](std::size_t i) { return std::pair(force[i], their_force[i]); }, size, worst_force);
    const Matrix<double> M = dynamics.mass_matrix(s);
    const auto their_M = twin.mass_matrix(s);
    compared(
        [&](std::size_t i) {
          return std::pair(M(static_cast<int>(i / size), static_cast<int>(i % size)),
                           their_M[i / size][i % size]);
        },
        size * size, worst_mass);
    std::vector<double> v;
    if (model.group == GroupKind::SE3) {
      for (int i = 0; i < 6; ++i) v.push_back(s.eta[i]);
    }
    v.insert(v.end(), s.r_dot.begin(), s.r_dot.end());
    double kinetic = 0;
    for (std::size_t i = 0; i < size; ++i) {
      for (std::size_t j = 0; j < size; ++j) kinetic += v[i] * their_M[i][j] * v[j] / 2;
    }
    worst_energy = std::max(worst_energy, std::abs(dynamics.energies(s).kinetic / kinetic - 1));
  }
  EXPECT_LT(worst_force, bound);
  EXPECT_LT(worst_mass, bound);
  EXPECT_LT(worst_energy, bound);
  std::printf("inverse dynamics %.1e, mass matrix %.1e, kinetic energy %.1e\n", worst_force, worst_mass,
              worst_energy);
}

constexpr double full_inertias = 3e-9, diagonal_inertias = 1e-12;

void compare_file(const std::string& name, double bound) {
  const auto path = std::filesystem::path(ANHOLON_SOURCE_DIR) / "tests" / "robot_files" / name;
  compare(read_bytes(path), testing::robot(name), bound);
}

TEST(Mujoco, Arm) { compare_file("arm.xml", full_inertias); }
TEST(Mujoco, Walker) { compare_file("walker.xml", diagonal_inertias); }

/// Everything that the reader knows of bodies and joints, but for couplings and dry friction, which are
/// constraints there.
TEST(Mujoco, EveryWayToWriteABody) {
  const std::string text = R"(<mujoco model="all">
  <compiler eulerseq="yzy"/>
  <option gravity="0.3 -0.2 -9.81"/>
  <default>
    <default class="stiff">
      <joint stiffness="30" springref="20"/>
      <default class="stiff_slide">
        <joint type="slide" damping="3" armature="0.6" axis="1 0 0"/>
      </default>
    </default>
    <joint damping="0.4" armature="0.07" axis="0.3 0 -1"/>
  </default>
  <worldbody>
    <body name="a" pos="0.1 0.2 0.3" euler="10 20 30" childclass="stiff">
      <inertial pos="0.1 0 0.2" quat="1 2 3 4" mass="3" diaginertia="0.03 0.04 0.05"/>
      <joint name="a1" pos="0.1 -0.2 0.3" ref="25"/>
      <joint name="a2" axis="0 1 0" pos="0 0 0.1"/>
      <joint name="a3" class="stiff_slide" ref="0.2"/>
      <joint name="a4" axis="1 1 1"/>
      <body name="b" pos="0.4 0 0" axisangle="1 2 -1 50">
        <inertial pos="0 0.1 0" xyaxes="1 0.2 0 0.1 1 1" mass="2" diaginertia="0.02 0.02 0.01"/>
        <joint name="b1" class="main" pos="0 0.2 0"/>
        <body name="c" pos="0 0 0.5" zaxis="1 0.5 -0.3">
          <inertial pos="0 0 0.1" zaxis="0 -1 0" mass="1" diaginertia="0.01 0.02 0.015"/>
          <joint name="c1" type="slide" springref="0.1" ref="-0.3"/>
        </body>
      </body>
      <body name="d" pos="0 0.3 0" xyaxes="0 1 0.1 -1 0 0">
        <inertial pos="0.02 0 0" axisangle="0 0 1 45" mass="0.7" diaginertia="0.004 0.005 0.006"/>
        <joint name="d1" class="main" axis="0 0 1" stiffness="5"/>
      </body>
    </body>
  </worldbody>
</mujoco>)";
  compare(text, read_robot_text(text, "all.xml"), diagonal_inertias);
}

/// Bodies whose mass and inertia are those of their geoms. One geom alone has its own axes for principal
/// ones.
std::string of_geoms(const std::string& second) {
  return R"(<mujoco><default><geom density="700" size="0.1 0.2 0.3"/><default class="light"><geom density="30"/></default></default>
  <worldbody><geom type="plane" size="1 1 1"/>
    <body name="a" pos="0 0 1"><freejoint/><geom type="box" pos="0.1 0 0.2" euler="10 20 30"/>
      <body name="b" pos="0.2 0 0"><joint name="jb" axis="0 1 0"/><geom type="capsule" fromto="0 0.1 0 0.3 0.2 0.5" size="0.05"/>
        <body name="c" pos="0.3 0.2 0.5"><joint name="jc" axis="1 0 0"/><geom type="cylinder" mass="2" quat="1 2 0 1"/>)" +
         second + R"(</body></body>
      <body name="d" pos="-0.2 0 0"><joint name="jd"/><geom pos="0 0 -0.3"/>
        <body name="e" pos="0 0 -0.5"><joint name="je" axis="0 1 1"/><geom type="ellipsoid" class="light"/></body></body>
    </body></worldbody></mujoco>)";
}
TEST(Mujoco, InertiasOfGeoms) {
  const std::string alone = of_geoms(""),
                    together =
                        of_geoms(R"(<geom type="capsule" pos="0.1 0.2 0" zaxis="1 1 0"/><geom mass="0"/>)");
  compare(alone, read_robot_text(alone, "geoms.xml"), diagonal_inertias);
  compare(together, read_robot_text(together, "geoms.xml"), full_inertias);
}

TEST(Mujoco, FixedEulerAxes) {
  const std::string text = R"(<mujoco><compiler eulerseq="YZX" angle="radian"/><worldbody>
    <body name="a" euler="0.3 0.4 0.5"><freejoint/><inertial pos="0 0 0.1" mass="2" diaginertia="0.1 0.2 0.25"/>
      <body name="b" pos="0.2 0 0" euler="1 -0.6 0.7"><joint name="j" axis="1 2 3"/>
        <inertial pos="0.1 0 0" euler="0.1 0.2 0.3" mass="1" diaginertia="0.03 0.04 0.05"/></body></body>
  </worldbody></mujoco>)";
  compare(text, read_robot_text(text, "fixed.xml"), diagonal_inertias);
}

}  // namespace
}  // namespace anholon::mujoco_test

#endif
