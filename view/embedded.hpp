#pragma once

#include <string>

/// Files that are part of the program.
namespace slalom::view {

/// The page, plain and compressed with gzip.
std::string page_html();
std::string page_gzip();
/// The schemas of the Foxglove messages that recordings contain, by name, as one JSON object
/// (https://docs.foxglove.dev/docs/visualization/message-schemas). Foxglove and Lichtblick show messages by
/// them.
std::string foxglove_schemas();

}  // namespace slalom::view
