// Questions of the load stream: positions, status, definitions, ranges of variables, and the commands of the controller itself.
// Source: on-line commands, Software Reference Manual p62-76.
#include <fmt/format.h>

#include <algorithm>

#include "compiler/bytecode/control.h"
#include "compiler/frontend/power_pmac/lowering.h"

namespace pmac::compiler::power_pmac {
namespace {

using ir::ControlVerb;

/// What p, v, d, f, t, g and ? ask of motors and of coordinate systems; kCount: nothing.
struct ReportRow { std::string_view word; ControlVerb of_motor, of_coord; };
constexpr ReportRow kReports[] = {
    {"p", ControlVerb::kReportPosition, ControlVerb::kReportCoordPosition},
    {"v", ControlVerb::kReportVelocity, ControlVerb::kReportCoordVelocity},
    {"d", ControlVerb::kReportDesired, ControlVerb::kReportCoordDesired},
    {"f", ControlVerb::kReportFollowingError, ControlVerb::kReportCoordFollowingError},
    {"t", ControlVerb::kCount, ControlVerb::kReportCoordTarget},
    {"g", ControlVerb::kCount, ControlVerb::kReportCoordDistanceToGo},
    {"?", ControlVerb::kReportStatus, ControlVerb::kReportCoordStatus}};

}  // namespace

/// p, v, d, f, t, g, ? for what was addressed last on this line, or else for the motor that is addressed; ? alone asks for the
/// status of the whole controller.
bool Lowering::lower_report(std::string_view word, source::Span span, ir::Body& out) {
  const auto* row = std::find_if(std::begin(kReports), std::end(kReports), [&](const ReportRow& r) { return r.word == word; });
  if (row == std::end(kReports)) return false;
  if (word == "?" && !addressed_on_line_) {
    add_control(ControlVerb::kReportGlobalStatus, span, {}, out);
    return true;
  }
  const bool of_coord = coord_addressed_last_ || row->of_motor == ControlVerb::kCount;
  for (ir::ExprPtr& number : of_coord ? addressed_coords(span) : addressed_motors(span)) {
    std::vector<ir::ExprPtr> arguments;
    arguments.push_back(std::move(number));
    add_control(of_coord ? row->of_coord : row->of_motor, span, std::move(arguments), out);
  }
  return true;
}

/// I123->: the element that the variable is another name for.
void Lowering::lower_alias_query(P::OnlineContext* online, ir::Body& out) {
  std::vector<ir::ExprPtr> arguments;
  arguments.push_back(ir::make_number(static_cast<double>(whole_number(token_of(online->NUMBER(0)), bytecode::kICount - 1).value_or(0)), span_of(online)));
  add_control(ControlVerb::kReportAlias, span_of(online), std::move(arguments), out);
}

/// #1..3->
void Lowering::lower_axis_query(P::OnlineContext* online, ir::Body& out) {
  std::vector<ir::ExprPtr> motors;
  if (online->numberList()) motors = lower_number_list(online->numberList());
  else motors.push_back(nullptr);
  for (ir::ExprPtr& motor : motors) {
    std::vector<ir::ExprPtr> arguments;
    arguments.push_back(std::move(motor));
    add_control(ControlVerb::kReportAxisDefinition, span_of(online), std::move(arguments), out);
  }
}

/// P1..5: one answer each.
void Lowering::lower_variable_range(P::OnlineContext* online, ir::Body& out) {
  constexpr std::int64_t kMost = 4096;
  const source::Span span = span_of(online);
  ir::ExprPtr first = lower_variable(online->variable());
  const auto* variable = first ? std::get_if<ir::Variable>(&first->node) : nullptr;
  const auto last = whole_number(token_of(online->NUMBER(0)), bytecode::kPCount - 1);
  if (!variable || !last) return;
  if (variable->index) return void(diagnostics_.error("PM3005", span, "a range of variables has constant numbers"));
  if (*last < variable->number) return void(diagnostics_.error("PM3005", span, fmt::format("the range {}..{} runs backwards", variable->number, *last)));
  if (*last - variable->number >= kMost) return void(diagnostics_.error("PM3005", span, fmt::format("a range has at most {} variables", kMost)));
  const std::string letter = text_of(online->variable()->start).substr(0, 1);
  for (std::int64_t n = variable->number; n <= *last; ++n)
    out.push_back(ir::make_stmt(span, ir::Report{std::make_unique<ir::Expr>(ir::Expr{span, ir::Variable{variable->variable_class, n, nullptr, {}}}), fmt::format("{}{}", letter, n)}));
}

/// list prog 5, list plc Cooling, list forward, list pc,3: the words, one blank between.
void Lowering::lower_list(P::ListedContext* listed, source::Span span, ir::Body& out) {
  std::string text = "list";
  if (listed && !listed->exception) {
    if (listed->kind) text += " " + lower_case(text_of(listed->kind));
    if (listed->bufferName()) text += " " + text_of(listed->bufferName()->start);
    if (listed->NAME()) text += " " + lower_case(text_of(token_of(listed->NAME())));
    const bool counted = listed->NAME() && listed->stop != listed->NAME()->getSymbol();
    if (counted) text += " ,";
    if (listed->NUMBER()) text += (counted ? "" : " ") + text_of(token_of(listed->NUMBER()));
  }
  out.push_back(ir::make_stmt(span, ir::SystemCommand{text}));
}

/// vers, echo 7, undefine all, define rotary 100: the words, in lower case, one blank between.
void Lowering::lower_system_command(P::OnlineContext* online, ir::Body& out) {
  std::string text;
  for (std::size_t i = online->start->getTokenIndex(); i <= online->stop->getTokenIndex(); ++i)
    text += (text.empty() ? "" : " ") + text_of(tree_.tokens->get(i));
  const bool of_coord = online->ROTARY() || lower_case(text) == "undefine";
  if (!of_coord) return out.push_back(ir::make_stmt(span_of(online), ir::SystemCommand{lower_case(text)}));
  if (coord_list_.empty()) return out.push_back(ir::make_stmt(span_of(online), ir::SystemCommand{lower_case(text)}));
  for (const std::int64_t coord : coord_list_)
    out.push_back(ir::make_stmt(span_of(online), ir::SystemCommand{lower_case(text) + (coord < 0 ? " &*" : fmt::format(" &{}", coord))}));
}

}  // namespace pmac::compiler::power_pmac
