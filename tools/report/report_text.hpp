#pragma once

#include <string>

#include "tools/report/report.hpp"

/// The words of a report.
namespace slalom::tools {

/// A text as HTML shows it.
std::string escaped(const std::string& text);
/// A number with up to `digits` decimals, fewer from 10 and from 100 on; a dash if it is not finite.
std::string number(double value, int digits = 3);
/// A p-value (0 .. 1), a dash where there is none.
std::string p_value(double p);

/// The style sheet of the report: for screens of any width, in light and dark colours, and for paper.
const char* report_style() noexcept;

/// A table of the experiments that are compared with the reference experiment of their scenario on the same
/// seeds, as a section; empty if nothing is compared.
std::string paired_table(const Report& report);

/// The terms that this report uses, as a section with the settings.
std::string glossary_html(const Report& report);

}  // namespace slalom::tools
