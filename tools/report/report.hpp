#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tools/evaluation/evaluation_job.hpp"
#include "tools/evaluation/reproduction.hpp"

/// An evaluation to look at: one HTML file that needs no other, and its figures as files of their own.
namespace slalom::tools {

/// An experiment as a row of a table.
struct ReportRow {
  std::string section, name, note;
  int experiment = 0;
};

struct Report {
  std::string title;
  const Evaluated& evaluated;
  std::vector<ReportRow> rows;
  std::vector<Reference> references;  ///< one per experiment; empty: nothing to compare with
  std::vector<std::string> notes;

  const evaluation::Experiment& experiment(const ReportRow& row) const {
    return evaluated.experiment(row.experiment);
  }
  const evaluation::ExperimentResult& result(const ReportRow& row) const {
    return evaluated.results[static_cast<std::size_t>(row.experiment)];
  }
  /// The sections of the rows, each once.
  std::vector<std::string> sections() const;
  /// Null without anything published.
  const Reference* reference(const ReportRow& row) const {
    const auto i = static_cast<std::size_t>(row.experiment);
    return i < references.size() && references[i].published ? &references[i] : nullptr;
  }
};

/// A figure with its caption.
struct ReportFigure {
  std::string name;     ///< name of its files
  std::string section;  ///< below which it stands; empty: at the end
  std::string title, caption;
  std::string svg{};  ///< the image
};

/// Boxes of costs and bars of collision rates for every section; times of computation. Writes SVG and PNG to
/// `folder`.
std::vector<ReportFigure> report_charts(const Report& report, const std::filesystem::path& folder);

/// Drives and draws Fig. 2 of the paper in the simulator: the same lap with MPPI (covariance 0.075) and with
/// SVG-MPPI, fig2a.png without obstacles and fig2b.png among obstacles. It is the first lap in which MPPI
/// hits an obstacle, or else the first. Draws nothing if the evaluation lacks one of the methods.
void draw_trajectories(const Evaluated& evaluated, const std::filesystem::path& folder);

// The words of a report.

/// A text as HTML shows it.
std::string escaped(const std::string& text);
/// A number with up to `digits` decimals, fewer from 10 and from 100 on; a dash if it is not finite.
std::string number(double value, int digits = 3);
/// The style sheet of the report: for screens of any width, in light and dark colours, and for paper.
extern const char* const report_style;
/// A table of the experiments that are compared with the reference experiment of their scenario on the same
/// seeds, as a section; empty if nothing is compared.
std::string paired_table(const Report& report);
/// The terms that this report uses, as a section with the settings.
std::string glossary_html(const Report& report);

/// Writes report.html, and figures/ beside it. Throws IoError.
void write_report(const Report& report, const std::filesystem::path& folder);

}  // namespace slalom::tools
