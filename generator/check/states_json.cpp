// SPDX-License-Identifier: GPL-2.0-or-later
#include "check/states_json.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <string>

#include "tape/interpret.hpp"

namespace anholon {
namespace {

using Json = nlohmann::ordered_json;

bool is_rotation(const Mat3<Exact>& R) {
  const Mat3<Exact> square = R * R.transposed();
  const Mat3<Exact> identity = Mat3<Exact>::identity();
  for (std::size_t i = 0; i < 9; ++i) {
    if (std::abs((square.m[i] - identity.m[i]).to_double()) > 1e-9) return false;
  }
  const auto row = [&](std::size_t i) { return Vec3<Exact>{R.m[3 * i], R.m[3 * i + 1], R.m[3 * i + 2]}; };
  return dot(row(0), cross(row(1), row(2))) > Exact(0);
}

class Reader {
 public:
  Reader(std::string file, const Model& model) : file_(std::move(file)), model_(model) {}

  StatesFile read(const Json& json) {
    StatesFile states;
    states.file = file_;
    const Json& coordinates = at(json, "coordinates", "the file");
    states.r_p = names(coordinates, "r_p", Drive::passive);
    states.r_a = names(coordinates, "r_a", Drive::active);
    for (const Parameter& p : model_.parameters) {
      Exact value = p.value;
      if (json.contains("parameters") && json["parameters"].contains(p.name)) {
        const Json& given = json["parameters"][p.name];
        value = number(given.is_object() ? at(given, "value", "parameter " + p.name) : given,
                       "parameter " + p.name);
      }
      states.parameters.push_back(value);
    }
    const Json& list = at(json, "states", "the file");
    if (!list.is_array()) fail("'states' is not a list", "give a list of {label, inputs}");
    for (const Json& entry : list) states.states.push_back(state(entry, states));
    return states;
  }

 private:
  [[noreturn]] void fail(const std::string& fact, const std::string& mend) const {
    throw ModelError({file_, 0, 0}, fact, mend);
  }

  const Json& at(const Json& object, const std::string& key, const std::string& where) const {
    if (!object.is_object() || !object.contains(key))
      fail(fmt::format("{} has no '{}'", where, key), "use the layout of docs/evaluate.md");
    return object[key];
  }

  Exact number(const Json& json, const std::string& where) const {
    try {
      if (json.is_string()) return Exact::from_decimal(json.get<std::string>());
      if (json.is_number_integer()) return Exact::from_decimal(json.dump());
      if (json.is_number()) return Exact::from_double(json.get<double>());
    } catch (const std::exception&) {
    }
    fail(fmt::format("{}: {} is not a finite number", where, json.dump().substr(0, 40)),
         "write a decimal number or a decimal string");
  }

  std::vector<Exact> numbers(const Json& inputs, const std::string& key, std::size_t size,
                             const std::string& where) const {
    const Json& list = at(inputs, key, where);
    if (!list.is_array() || list.size() != size)
      fail(fmt::format("{}: '{}' has {} entries, not {}", where, key, list.size(), size),
           "give one number for each coordinate");
    std::vector<Exact> result;
    const std::string what = fmt::format("{}, {}", where, key);
    for (const Json& e : list) result.push_back(number(e, what));
    return result;
  }

  std::vector<std::string> names(const Json& coordinates, const std::string& key, Drive drive) const {
    std::vector<std::string> result;
    if (coordinates.contains(key)) {
      for (const Json& e : coordinates[key])
        result.push_back(e.is_string() ? e.get<std::string>() : e.dump());
    }
    std::vector<std::string> expected;
    for (const Coordinate& c : model_.coordinates) {
      if (c.drive == drive) expected.push_back(c.name);
    }
    if (!std::ranges::is_permutation(result, expected)) {
      std::string list;
      for (const std::string& name : expected) list += (list.empty() ? "" : ", ") + name;
      fail(fmt::format("coordinates.{} does not name the model's coordinates", key),
           fmt::format("the model has ({})", list));
    }
    return result;
  }

  std::size_t index(const std::string& name) const {
    return static_cast<std::size_t>(std::ranges::find(model_.coordinates, name, &Coordinate::name) -
                                    model_.coordinates.begin());
  }

  StatesFile::Entry state(const Json& entry, const StatesFile& file) const {
    StatesFile::Entry result;
    result.label =
        entry.contains("label") && entry["label"].is_string() ? entry["label"].get<std::string>() : "";
    const std::string where = result.label.empty() ? "a state" : "state '" + result.label + "'";
    const Json& inputs = at(entry, "inputs", where);
    State<Exact>& s = result.input.state;
    if (inputs.contains("g")) {
      const Json& g = inputs["g"];
      const Json& R = at(g, "R", where + ", g");
      if (!R.is_array() || R.size() != 3)
        fail(where + ": g.R is not a 3x3 matrix", "give three rows of three numbers");
      for (std::size_t i = 0; i < 3; ++i) {
        if (!R[i].is_array() || R[i].size() != 3)
          fail(where + ": g.R is not a 3x3 matrix", "give three rows of three numbers");
        for (std::size_t j = 0; j < 3; ++j) s.R.m[3 * i + j] = number(R[i][j], where + ", g.R");
      }
      if (!is_rotation(s.R))
        fail(where + ": g.R is not a rotation", "its rows must be orthonormal to 1e-9, its determinant 1");
      const auto p = numbers(g, "p", 3, where + ", g");
      for (int i = 0; i < 3; ++i) s.p[i] = p[static_cast<std::size_t>(i)];
    }
    if (inputs.contains("t")) s.t = number(inputs["t"], where + ", t");
    const auto components = free_components(model_.group);
    if (!components.empty()) {
      const auto eta = numbers(inputs, "eta", components.size(), where);
      for (std::size_t i = 0; i < components.size(); ++i) s.eta[components[i]] = eta[i];
    }
    if (inputs.contains("eta_dot")) {
      const auto eta_dot = numbers(inputs, "eta_dot", components.size(), where);
      for (std::size_t i = 0; i < components.size(); ++i) result.eta_dot[components[i]] = eta_dot[i];
    }
    const std::size_t size = model_.coordinates.size();
    s.r.assign(size, Exact(0)), s.r_dot.assign(size, Exact(0));
    result.input.r_ddot.assign(size, Exact(0)), result.input.tau.assign(size, Exact(0));
    const auto fill = [&](const std::string& key, const std::vector<std::string>& coordinates,
                          std::vector<Exact>& to) {
      if (coordinates.empty()) return;
      const auto values = numbers(inputs, key, coordinates.size(), where);
      for (std::size_t i = 0; i < values.size(); ++i) to[index(coordinates[i])] = values[i];
    };
    fill("r_p", file.r_p, s.r), fill("r_a", file.r_a, s.r), fill("rdot_p", file.r_p, s.r_dot),
        fill("rdot_a", file.r_a, s.r_dot);
    result.input.has_acceleration = file.r_a.empty() || inputs.contains("rddot_a");
    if (result.input.has_acceleration) fill("rddot_a", file.r_a, result.input.r_ddot);
    result.input.has_torque = !file.r_a.empty() && inputs.contains("tau_a");
    if (result.input.has_torque) fill("tau_a", file.r_a, result.input.tau);
    if (inputs.contains("lambda_stat"))  // how many there must be is known when the ranks are
      result.input.lambda_stat = numbers(inputs, "lambda_stat", inputs["lambda_stat"].size(), where);
    return result;
  }

  std::string file_;
  const Model& model_;
};

template <class S>
Json to_json(const S& x, unsigned digits) {
  if constexpr (std::is_same_v<S, Exact>) {
    return x.decimal(digits);
  } else {
    return x;
  }
}
template <class S>
Json to_json(const std::vector<S>& v, unsigned digits) {
  Json list = Json::array();
  for (const S& x : v) list.push_back(to_json(x, digits));
  return list;
}
template <class S>
Json to_json(const Matrix<S>& m, unsigned digits) {
  Json list = Json::array();
  for (int i = 0; i < m.rows() && m.cols() > 0; ++i) {
    Json row = Json::array();
    for (int j = 0; j < m.cols(); ++j) row.push_back(to_json(m(i, j), digits));
    list.push_back(std::move(row));
  }
  return list;
}

}  // namespace

StatesFile read_states(const std::filesystem::path& path, const Model& model) {
  std::ifstream stream(path);
  if (!stream || std::filesystem::is_directory(path))
    throw ModelError({path.string(), 0, 0}, "cannot be read", "check the path");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {  // its byte is the first that does not fit, from 1
    const std::string before = text.substr(0, error.byte == 0 ? 0 : error.byte - 1);
    const auto line = 1 + std::ranges::count(before, '\n');
    const std::size_t column = before.size() - (before.rfind('\n') + 1) + 1;  // npos + 1 == 0
    throw ModelError({path.string(), static_cast<int>(line), static_cast<int>(column)}, "this is not JSON",
                     "mend the syntax here");
  } catch (const Json::out_of_range& error) {
    throw ModelError({path.string(), 0, 0},
                     fmt::format("has a number that no double holds: {}", error.what()),
                     "write it as a string");
  }
  return Reader(path.string(), model).read(json);
}

template <class S>
EvaluationInput<S> rounded_input(const EvaluationInput<Exact>& input) {
  const FromExact<S> round;
  const auto all = [&](const std::vector<Exact>& from) {
    std::vector<S> to;
    for (const Exact& x : from) to.push_back(round(x));
    return to;
  };
  EvaluationInput<S> r;
  for (std::size_t i = 0; i < 9; ++i) r.state.R.m[i] = round(input.state.R.m[i]);
  for (int i = 0; i < 3; ++i) r.state.p[i] = round(input.state.p[i]);
  for (int i = 0; i < 6; ++i) r.state.eta[i] = round(input.state.eta[i]);
  r.state.t = round(input.state.t);
  r.state.r = all(input.state.r), r.state.r_dot = all(input.state.r_dot);
  r.r_ddot = all(input.r_ddot), r.tau = all(input.tau), r.lambda_stat = all(input.lambda_stat);
  r.has_acceleration = input.has_acceleration, r.has_torque = input.has_torque;
  return r;
}

template <class S>
Json answer(const Model& model, const StatesFile& file, const Evaluated<S>& e,
            const EvaluationInput<S>& input, unsigned digits) {
  const Partition partition = partition_of(model);
  const int n = partition.n;
  std::vector<int> eta, r_p, r_a, rows;
  for (int i = 0; i < n; ++i) eta.push_back(i);
  const auto index = [&](const std::string& name) {
    return n + static_cast<int>(std::ranges::find(model.coordinates, name, &Coordinate::name) -
                                model.coordinates.begin());
  };
  for (const std::string& name : file.r_p) r_p.push_back(index(name));
  for (const std::string& name : file.r_a) r_a.push_back(index(name));
  for (int i = 0; i < e.G.rows(); ++i) rows.push_back(i);
  const auto pick = [](const std::vector<S>& v, const std::vector<int>& at) {
    std::vector<S> r;
    for (const int i : at) r.push_back(v[static_cast<std::size_t>(i)]);
    return r;
  };
  const auto j = [&](const auto& x) { return to_json(x, digits); };
  const char* lambda = e.least_norm ? "lambda_min_norm" : "lambda";
  std::vector<int> passive = eta;
  passive.insert(passive.end(), r_p.begin(), r_p.end());
  const auto position = [](const std::vector<int>& order, const std::vector<int>& of) {
    std::vector<int> r;
    for (const int i : of) r.push_back(static_cast<int>(std::ranges::find(order, i) - order.begin()));
    return r;
  };
  const std::vector<int> passive_at = position(partition.passive, passive);
  const std::vector<int> active_at = position(partition.active, r_a);

  Json out;
  out["M_eta_eta"] = j(e.M.block(eta, eta)), out["M_p"] = j(e.M.block(r_p, eta)),
  out["M_a"] = j(e.M.block(r_a, eta));
  out["m_pp"] = j(e.M.block(r_p, r_p)), out["m_pa"] = j(e.M.block(r_p, r_a)),
  out["m_aa"] = j(e.M.block(r_a, r_a));
  out["f"] = j(pick(e.force, eta)), out["Q_p"] = j(pick(e.force, r_p)), out["Q_a"] = j(pick(e.force, r_a));
  out["A"] = j(e.G.block(rows, eta)), out["B_p"] = j(e.G.block(rows, r_p)),
  out["B_a"] = j(e.G.block(rows, r_a));
  out["constraint_bias_Gdot_v"] = j(e.bias);
  out["kernel_projector"] = j(e.projector.block(passive_at, passive_at));
  if (input.has_acceleration) {
    Json& g = out["given_r_a"];
    g["eta_dot"] = j(pick(e.acceleration, eta)), g["r_p_ddot"] = j(pick(e.acceleration, r_p));
    g[lambda] = j(e.lambda), g["tau_a"] = j(pick(e.tau_a, active_at));
  }
  if (input.has_torque) {
    Json& g = out["given_tau_a"];
    g["eta_dot"] = j(pick(e.free_acceleration, eta)), g["r_p_ddot"] = j(pick(e.free_acceleration, r_p));
    g["r_a_ddot"] = j(pick(e.free_acceleration, r_a)), g[lambda] = j(e.free_lambda);
  }
  S actuator = S(0);
  if (input.has_acceleration) {
    for (std::size_t i = 0; i < partition.active.size(); ++i)
      actuator = actuator + e.tau_a[i] * input.state.r_dot[static_cast<std::size_t>(partition.active[i] - n)];
  }
  out["energy"] = {{"kinetic", j(e.kinetic)},
                   {"gravity", j(e.gravity)},
                   {"elastic", j(e.elastic)},
                   {"total", j(e.kinetic + e.gravity + e.elastic)},
                   {"dissipated_power", j(e.dissipated_power)},
                   {"actuator_power", j(actuator)}};
  if (!e.basis.empty()) {
    std::vector<int> columns(static_cast<std::size_t>(e.H.cols()));
    for (std::size_t i = 0; i < columns.size(); ++i) columns[i] = static_cast<int>(i);
    out["reduced"] = {{"basis", e.basis},
                      {"H", j(e.H.block(passive_at, columns))},
                      {"J", j(e.J.block(passive_at, active_at))},
                      {"nu", j(e.nu)},
                      {"nu_dot", j(e.nu_dot)},
                      {"M_r", j(e.M_r)},
                      {"f_r", j(e.f_r)}};
  }
  return out;
}

template <class S>
Json number_list(const std::vector<S>& values, unsigned digits) {
  return to_json(values, digits);
}

template Json number_list(const std::vector<double>&, unsigned);
template Json number_list(const std::vector<Exact>&, unsigned);
template EvaluationInput<double> rounded_input(const EvaluationInput<Exact>&);
template EvaluationInput<Exact> rounded_input(const EvaluationInput<Exact>&);
template Json answer(const Model&, const StatesFile&, const Evaluated<double>&,
                     const EvaluationInput<double>&, unsigned);
template Json answer(const Model&, const StatesFile&, const Evaluated<Exact>&, const EvaluationInput<Exact>&,
                     unsigned);

}  // namespace anholon
