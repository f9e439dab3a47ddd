#pragma once

#include "tools/evaluation/evaluation_job.hpp"
#include "tools/evaluation/reproduction.hpp"
#include "tools/terminal/text_table.hpp"

/// An evaluation to look at: one HTML file that needs no other, with the tables of the terminal and with
/// charts, which are also files of their own.
namespace slalom::tools {

/// A row of a chart: the results of a method in path tracking and among obstacles, null without any.
struct ChartRow {
  std::string name;
  const evaluation::ExperimentResult *tracking = nullptr, *obstacles = nullptr;
};

/// A chart of boxes of costs and bars of collision rates, beside those of the references if there are any.
struct ReportChart {
  std::string file;  ///< its name, without the ending
  std::string title;
  std::vector<ChartRow> rows;
};

struct Report {
  std::string title;
  const Evaluated& evaluated;
  std::vector<Reference> references;  ///< one per experiment; empty: nothing to compare with
  std::vector<std::string> notes;
  std::vector<std::pair<std::string, TextTable>> tables;  ///< with their titles
  std::vector<ReportChart> charts;
};

/// Writes report.html, and figures/ beside it as SVG and PNG. Throws IoError.
void write_report(const Report& report, const std::filesystem::path& folder);

}  // namespace slalom::tools
