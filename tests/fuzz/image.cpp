// Images of maps: PNG and PGM.
#include "slalom/maps/image.hpp"

#include "fuzz/target.hpp"
#include "slalom/core/error.hpp"
#include "support/temporary_folder.hpp"

namespace slalom::fuzz {
namespace {

std::vector<std::string> seeds() {
  maps::GreyImage image{5, 4, {}, {}};
  for (int i = 0; i < 20; ++i) image.grey.push_back(static_cast<std::uint8_t>(12 * i));
  const std::string png = scratch_folder() + "/seed.png";
  maps::save_png(image, png);
  return {testing::content(png), "P5\n# by hand\n3 2\n255\nabcdef", "P2\n3 2\n15\n0 1 2\n13 14 15\n"};
}

bool run(std::string_view bytes) {
  try {
    const maps::GreyImage image = maps::load_image(scratch_file("image", bytes));
    const auto pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    require(image.width > 0 && image.height > 0 && image.grey.size() == pixels, "an image has its pixels");
    require(image.opacity.empty() || image.opacity.size() == pixels,
            "an image has the opacity of its pixels");
    return true;
  } catch (const IoError&) {
    return false;
  }
}

const Target target("image", 1 << 14, seeds, run);

}  // namespace
}  // namespace slalom::fuzz
