#pragma once

#include <filesystem>
#include <string>

namespace slalom::tools {

/// The page of the live view with a recording inside. Notes on standard error how many bytes of a recording
/// that was cut are lost. Throws IoError.
std::string page_of_recording(const std::filesystem::path& recording);

}  // namespace slalom::tools
