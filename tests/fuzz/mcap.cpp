// MCAP recordings: opening, reading attachments.
#include <optional>
#include <sstream>

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"
#include "view/recording/mcap_writer.hpp"
#include "view/recording/replay.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  std::vector<std::string> seeds;
  for (const int messages : {0, 3, 40}) {
    std::ostringstream stream;
    view::mcap::Writer writer(stream, "slalom", 256);
    const auto channel = writer.add_channel("/tick", "json", writer.add_schema("tick", "jsonschema", "{}"));
    writer.add_metadata("slalom", {{"seed", "4"}, {"course", "wren"}});
    for (int i = 0; i < messages; ++i)
      writer.add_message(channel, static_cast<std::uint64_t>(i) * 50000000,
                         "{\"tick\":" + std::to_string(i) + "}");
    view::ReplaySegments replay([&, number = 0](const std::string& segment) mutable {
      writer.add_attachment("replay/" + std::to_string(number++) + ".gz", "application/gzip", 7, segment);
    });
    replay.add_text("{}");
    replay.finish();
    replay.add_text("[]");
    replay.finish();
    writer.finish();
    seeds.push_back(std::move(stream).str());
  }
  seeds.push_back(seeds.back().substr(0, seeds.back().size() / 2));
  return seeds;
}

/// Returns the result of `load`, or nothing if it throws IoError.
template <class Load>
auto loaded(Load&& load) -> std::optional<decltype(load())> {
  try {
    return load();
  } catch (const IoError&) {
    return std::nullopt;
  }
}

bool run(std::string_view bytes) {
  const std::string file = scratch_file("lap.mcap", bytes);
  const auto whole = loaded([&] { return view::load_replay(file); });
  std::uint64_t lost = 0;
  const auto kept = loaded([&] { return view::load_replay(file, &lost); });
  if (whole) require(kept && *kept == *whole, "a recording that is whole opens the same where a cut one may");
  require(lost <= bytes.size(), "no more is lost than there was");
  return whole.has_value();
}

const Target target("mcap", 1 << 15, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
