// SPDX-License-Identifier: GPL-2.0-or-later
#include <fmt/format.h>

#include "cli/common.hpp"
#include "emit/equations.hpp"

namespace anholon::cli {

int explain(const ExplainOptions& options) {
  const Model model = load_model(options);
  DeriveRequest request = derive_request(options, model);
  request.functions = equation_functions();
  const auto derivation = derive(model, request);
  EquationStyle style;
  style.brief = options.brief;
  if (options.brief) {  // a section of the model's own page
    style.heading = "###";
    write_output(options.output, equations(model, *derivation, style));
    return ok;
  }
  write_output(options.output,
               fmt::format("# {}: equations\n\n{}", model.title.empty() ? model.name : model.title,
                           equations(model, *derivation, style)));
  return ok;
}

}  // namespace anholon::cli
