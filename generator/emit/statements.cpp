// SPDX-License-Identifier: GPL-2.0-or-later
#include "emit/statements.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <queue>
#include <set>
#include <stdexcept>
#include <unordered_map>

namespace anholon {
namespace {

constexpr auto nowhere = static_cast<std::size_t>(-1);
constexpr std::size_t shortest_run =
    8;  // equal constants side by side that a split function fills in by a loop

constexpr std::array<std::string_view, 4> own_functions = {"product_error", "quotient_error", "sign",
                                                           "sum_error"};

/// Writes one function; knows for each node in which block it is made and where it is kept.
class StatementWriter {
 public:
  StatementWriter(const Tape& tape, const std::vector<Assignment>& results, const GivenValues& given,
                  NameScope names, const StatementStyle& style)
      : tape_(tape), results_(results), given_(given), names_(std::move(names)), style_(style) {}

  Statements write() {
    std::vector<NodeId> roots;
    for (const Assignment& result : results_) roots.push_back(result.node);
    std::vector<NodeId> given;
    for (const auto& [id, value] : given_) given.push_back(id);
    order_ = emission_order(tape_, roots, given, style_.order);
    name_temporaries();
    const bool split = order_.nodes.size() + results_.size() > style_.split_above;
    const std::size_t block_size =
        split ? std::max<std::size_t>(1, style_.block_size) : std::max<std::size_t>(1, order_.nodes.size());
    if (split) place_carried(block_size);
    is_written_.assign(order_.nodes.size(), false);

    Statements out;
    out.carried_size = slot_count_;
    out.carried = carried_;
    name_batch();
    for (std::size_t begin = 0; begin < order_.nodes.size(); begin += block_size) {
      const std::size_t end = std::min(begin + block_size, order_.nodes.size());
      start_text();
      if (begin == 0) keep_inputs();
      write_batch(begin, std::min(end, order_.sincos));
      for (std::size_t i = begin; i < end; ++i) {
        if (!is_written_[i]) write_operation(i);
      }
      if (!split) break;
      finish_block(out);
    }
    if (split || order_.nodes.empty()) start_text();
    if (!order_.nodes.empty() && !split && !results_.empty()) lines_ += "\n";
    block_ = nowhere;
    write_results(out, split ? block_size : 0);
    out.text = finish_text();
    out.uses_batch = uses_batch_;
    all_arguments_.insert(arguments_.begin(), arguments_.end());
    out.arguments.assign(all_arguments_.begin(), all_arguments_.end());
    return out;
  }

 private:
  /// Writes the results that are still to come, in blocks of so many lines where that is not zero and they
  /// are arguments.
  void write_results(Statements& out, std::size_t block_size) {
    std::vector<Assignment> late;
    for (const Assignment& result : results_) {
      if (!is_direct(result)) late.push_back(result);
    }
    const bool in_blocks = block_size > 0 && !late.empty() && late[0].argument != Assignment::none;
    const std::string index = in_blocks ? names_.claim("i") : "";
    for (std::size_t i = 0, lines = 0; i < late.size(); ++lines) {
      i += write_result(late, i, index);
      if (!in_blocks || ((lines + 1) % block_size != 0 && i < late.size())) continue;
      finish_block(out);
      start_text();
    }
  }

  /// Writes a result, or a run of equal constants where `index`, the variable of a loop, has a name.
  /// @return how many results that were
  std::size_t write_result(const std::vector<Assignment>& results, std::size_t i, const std::string& index) {
    const Assignment& first = results[i];
    std::size_t run = 1;
    if (!index.empty() && first.entry != Assignment::none && tape_.node(first.node).op == Op::constant) {
      while (i + run < results.size() && results[i + run].node == first.node &&
             results[i + run].target == first.target && results[i + run].entry == first.entry + run)
        ++run;
    }
    if (run < shortest_run) {
      assign(first);
      return 1;
    }
    const std::string value = operand(first.node);
    arguments_.insert(first.argument);
    lines_ += fmt::format("  for (int {0} = {1}; {0} < {2}; ++{0}) {3}[{0}] = {4};\n", index, first.entry,
                          first.entry + run, first.target, value);
    return run;
  }

  void assign(const Assignment& result) {
    const std::string value = operand(result.node);
    if (result.argument != Assignment::none) arguments_.insert(result.argument);
    const std::string entry = result.entry == Assignment::none ? "" : fmt::format("[{}]", result.entry);
    lines_ += fmt::format("  {}{} = {};\n", result.target, entry, value);
  }

  /// Whether a result of a split function is stored where it is made: behind the first block, which has kept
  /// the inputs, so that an output may lie over an input.
  [[nodiscard]] bool is_direct(const Assignment& result) const {
    return !block_of_.empty() && result.argument != Assignment::none && !given_.contains(result.node) &&
           block_of_[result.node] != nowhere && block_of_[result.node] > 0;
  }

  /// sin and cos of an input keep its name; other temporaries are numbered.
  void name_temporaries() {
    temporary_.assign(tape_.size(), {});
    for (std::size_t i = 0; i < order_.sincos; ++i) {
      const Node& n = tape_.node(order_.nodes[i]);
      if ((n.op != Op::sin && n.op != Op::cos) || tape_.node(n.a).op != Op::input) continue;
      const std::string& argument = tape_.inputs()[tape_.node(n.a).a];
      temporary_[order_.nodes[i]] = names_.claim((n.op == Op::sin ? "s_" : "c_") + argument);
    }
    int number = 0;
    for (const NodeId id : order_.nodes) {
      if (!temporary_[id].empty()) continue;
      std::string name;
      do name = fmt::format("t{}", ++number);
      while (names_.is_taken(name));
      temporary_[id] = std::move(name);
    }
  }

  /// Slots of the array through which a value goes from its block to later ones; a slot is free again after
  /// the last block that reads it.
  void place_carried(std::size_t block_size) {
    carried_ = names_.claim("carried");
    block_of_.assign(tape_.size(), nowhere);
    slot_.assign(tape_.size(), nowhere);
    std::vector<std::size_t> last_use(tape_.size(), 0);
    const std::size_t at_the_end = order_.nodes.size() / block_size + 1;
    const auto use = [&](NodeId id, std::size_t block) { last_use[id] = std::max(last_use[id], block); };
    for (std::size_t i = 0; i < order_.nodes.size(); ++i) {
      const NodeId id = order_.nodes[i];
      block_of_[id] = i / block_size;
      use(tape_.node(id).a, i / block_size);
      if (info(tape_.node(id).op).arity == 2) use(tape_.node(id).b, i / block_size);
    }
    for (const Assignment& result : results_) {
      if (is_direct(result)) {
        direct_[result.node].push_back(&result);
      } else {
        use(result.node, at_the_end);
      }
    }
    using Slots = std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>>;
    Slots unused;
    std::vector<std::vector<std::size_t>> freed(at_the_end + 2);
    const auto keep = [&](NodeId id) {
      if (unused.empty()) unused.push(slot_count_++);
      slot_[id] = unused.top();
      unused.pop();
      freed[last_use[id] + 1].push_back(slot_[id]);
    };
    for (NodeId id = 0; id < tape_.size(); ++id) {  // in an order that does not depend on the run
      const auto given = given_.find(id);
      if (given == given_.end() || given->second.argument == 0 || last_use[id] == 0) continue;
      kept_inputs_.push_back(id);
      keep(id);
    }
    for (std::size_t i = 0; i < order_.nodes.size(); ++i) {
      const NodeId id = order_.nodes[i];
      const std::size_t block = block_of_[id];
      if (i % block_size == 0) {
        for (const std::size_t slot : freed[block]) unused.push(slot);
      }
      if (last_use[id] > block) keep(id);
    }
  }

  void name_batch() {
    if (style_.sincos != SinCos::batch) return;
    for (std::string* name : {&angle_, &sine_, &cosine_})
      *name = names_.claim(name == &angle_ ? "angle" : name == &sine_ ? "sine" : "cosine");
  }

  /// Writes the sines and cosines among the operations [begin, end) together, behind what their angles need.
  void write_batch(std::size_t begin, std::size_t end) {
    if (style_.sincos != SinCos::batch) return;
    std::vector<NodeId> angles;
    std::vector<std::pair<std::size_t, std::size_t>> calls;  // operation, index of its angle
    for (std::size_t i = begin; i < end; ++i) {
      const Node& n = tape_.node(order_.nodes[i]);
      if (n.op != Op::sin && n.op != Op::cos) continue;
      const auto found = std::find(angles.begin(), angles.end(), n.a);
      calls.emplace_back(i, static_cast<std::size_t>(found - angles.begin()));
      if (found == angles.end()) angles.push_back(n.a);
    }
    if (angles.size() < 2) return;  // nothing to do side by side
    uses_batch_ = true;
    for (std::size_t i = begin; i < end; ++i) {
      const Op op = tape_.node(order_.nodes[i]).op;
      if (op == Op::sin || op == Op::cos) continue;
      write_operation(i);
      is_written_[i] = true;
    }
    // whole vectors of four; those in excess are of angle 0
    const std::size_t size = (angles.size() + 3) / 4 * 4;
    std::string list;
    block_ = block_of_.empty() ? 0 : block_of_[order_.nodes[begin]];
    for (const NodeId a : angles) list += (list.empty() ? "" : ", ") + operand(a);
    for (std::size_t i = angles.size(); i < size; ++i) {
      list += ", constant<Real>(0.0L)";
      uses_constant_ = true;
    }
    lines_ += fmt::format("  const Real {}[{}] = {{{}}};\n", angle_, size, list);
    lines_ += fmt::format("  Real {0}[{2}], {1}[{2}];\n", sine_, cosine_, size);
    lines_ += fmt::format("  detail::sines_cosines({}, {}, {});\n", angle_, sine_, cosine_);
    for (const auto& [i, angle] : calls) {
      const NodeId id = order_.nodes[i];
      const bool is_sine = tape_.node(id).op == Op::sin;
      lines_ += fmt::format("  const Real {} = {}[{}];\n", temporary_[id], is_sine ? sine_ : cosine_, angle);
      store(id);
      is_written_[i] = true;
    }
  }

  void finish_block(Statements& out) {
    out.blocks.push_back({{arguments_.begin(), arguments_.end()}, uses_carried_, finish_text()});
    all_arguments_.insert(arguments_.begin(), arguments_.end());
  }

  void start_text() {
    lines_.clear();
    functions_.clear();
    arguments_.clear();
    uses_carried_ = false;
    uses_constant_ = false;
    title_ = nowhere;
  }

  std::string finish_text() {
    std::string head;
    for (const std::string& name : functions_) {
      if (std::ranges::find(own_functions, name) == own_functions.end())
        head += fmt::format("  using std::{};\n", name);
    }
    if (uses_constant_) head += "  using detail::constant;\n";
    for (const std::string_view name : own_functions) {
      if (functions_.contains(std::string(name))) head += fmt::format("  using detail::{};\n", name);
    }
    return head + lines_;
  }

  void write_operation(std::size_t index) {
    const NodeId id = order_.nodes[index];
    const Node& n = tape_.node(id);
    block_ = block_of_.empty() ? 0 : block_of_[id];
    write_title(index < order_.sincos ? 0 : tape_.section_of(id));
    const OpInfo& op = info(n.op);
    if (op.cpp.back() == ')') functions_.insert(std::string(op.name));
    const std::string a = operand(n.a);
    const std::string value = fmt::format(fmt::runtime(op.cpp), a, op.arity == 2 ? operand(n.b) : a);
    lines_ += fmt::format("  const Real {} = {};\n", temporary_[id], value);
    store(id);
  }

  /// Hands the inputs that they read on to the blocks behind the first.
  void keep_inputs() {
    block_ = 0;
    for (const NodeId id : kept_inputs_) carry(id, operand(id));
  }

  /// Hands a value on to the blocks behind.
  void carry(NodeId id, const std::string& value) {
    if (slot_.empty() || slot_[id] == nowhere) return;
    uses_carried_ = true;
    lines_ += fmt::format("  {}[{}] = {};\n", carried_, slot_[id], value);
  }

  /// Puts a value that was just made where it is needed later.
  void store(NodeId id) {
    carry(id, temporary_[id]);
    if (const auto found = direct_.find(id); found != direct_.end()) {
      for (const Assignment* result : found->second) assign(*result);
    }
  }

  void write_title(std::size_t section) {
    if (section == title_) return;
    title_ = section;
    const std::string& title = tape_.sections()[section];
    if (title.empty()) return;
    if (!lines_.empty()) lines_ += "\n";
    lines_ += comment(title, "  // ");
  }

  std::string operand(NodeId id) {
    if (const auto found = given_.find(id); found != given_.end()) {
      if (!slot_.empty() && slot_[id] != nowhere && block_ != 0) return carried_value(id);
      arguments_.insert(found->second.argument);
      return found->second.text;
    }
    const Node& n = tape_.node(id);
    if (n.op == Op::constant) {
      uses_constant_ = true;
      return constant_text(tape_.value(id));
    }
    if (n.op == Op::input) {
      throw std::logic_error(fmt::format(
          "an output needs '{}', which is neither a parameter nor in an input block", tape_.inputs()[n.a]));
    }
    return slot_.empty() || block_of_[id] == block_ ? temporary_[id] : carried_value(id);
  }

  std::string carried_value(NodeId id) {
    uses_carried_ = true;
    return fmt::format("{}[{}]", carried_, slot_[id]);
  }

  const Tape& tape_;
  const std::vector<Assignment>& results_;
  const GivenValues& given_;
  NameScope names_;
  const StatementStyle& style_;

  EmissionOrder order_;
  std::vector<std::string> temporary_;
  std::vector<std::size_t> block_of_, slot_;  // empty where the function is not split
  std::vector<NodeId> kept_inputs_;           // read behind the first block
  std::unordered_map<NodeId, std::vector<const Assignment*>> direct_;  // results by the node that they are
  std::size_t slot_count_ = 0;
  std::string carried_;

  std::string angle_, sine_, cosine_;  // arrays of the batch
  std::vector<bool> is_written_;       // operations
  bool uses_batch_ = false;

  std::string lines_;
  std::set<std::string> functions_;
  std::set<std::size_t> arguments_, all_arguments_;  // of a block, of all blocks so far
  bool uses_carried_ = false, uses_constant_ = false;
  std::size_t title_ = nowhere;
  std::size_t block_ = 0;
};

/// Bytes of the UTF-8 sequence at `at` that may stand in a comment: none of a control character or of one
/// that turns the direction of writing (U+202A..202E, U+2066..2069).
std::size_t printable_bytes(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U; };
  const unsigned first = byte(at);
  if (first < 0x20 || first == 0x7F) return 0;
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC2 ? 2 : 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(at + i) & 0xC0U) != 0x80) return 0;
  }
  if (first == 0xE2 && byte(at + 1) == 0x80 && byte(at + 2) >= 0xAA && byte(at + 2) <= 0xAE) return 0;
  if (first == 0xE2 && byte(at + 1) == 0x81 && byte(at + 2) >= 0xA6 && byte(at + 2) <= 0xA9) return 0;
  if (first == 0xC2 && byte(at + 1) < 0xA0) return 0;
  return length;
}

/// Columns of UTF-8 text: bytes that do not continue a character.
std::size_t columns(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80; }));
}

}  // namespace

Statements write_statements(const Tape& tape, const std::vector<Assignment>& results,
                            const GivenValues& given, NameScope names, const StatementStyle& style) {
  return StatementWriter(tape, results, given, std::move(names), style).write();
}

std::string constant_text(const Exact& value) {
  std::string digits = value.decimal(21);
  if (digits.find_first_of(".e") == std::string::npos) digits += ".0";
  return fmt::format("constant<Real>({}L)", digits);
}

std::string comment(std::string_view text, std::string_view prefix, std::size_t hang, std::size_t width) {
  const std::string later = std::string(prefix) + std::string(hang, ' ');
  std::string result;
  std::string line(prefix);
  bool has_word = false;
  const auto end_line = [&] {
    line.erase(line.find_last_not_of(" \\") + 1);
    result += line + "\n";
    line = later;
    has_word = false;
  };
  std::string word;
  const auto end_word = [&] {
    if (word.empty()) return;
    if (has_word && columns(line) + 1 + columns(word) > width) end_line();
    if (has_word) line += ' ';
    line += word;
    word.clear();
    has_word = true;
  };
  for (std::size_t i = 0; i < text.size();) {
    if (text[i] == '\n') {
      end_word();
      end_line();
      ++i;
    } else if (text[i] == ' ' || text[i] == '\t') {
      end_word();
      ++i;
    } else if (const std::size_t bytes = printable_bytes(text, i); bytes > 0) {
      word += text.substr(i, bytes);
      i += bytes;
    } else {
      word += '?';
      ++i;
    }
  }
  end_word();
  if (has_word || result.empty()) end_line();
  return result;
}

std::string one_line(std::string_view text) {
  std::string flat(text);
  std::replace(flat.begin(), flat.end(), '\n', ' ');
  flat = comment(flat, "", 0, std::string::npos);
  flat.pop_back();
  return flat;
}

std::string origin(std::string_view text) { return text.empty() ? "none" : one_line(text); }

}  // namespace anholon
