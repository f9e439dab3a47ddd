#pragma once

#include <string>
#include <vector>

namespace slalom::tools {

/// The word of a list that was most likely meant: the one with the fewest insertions, deletions,
/// substitutions and transpositions of neighbours (Damerau, 1964), at most one for every three characters,
/// and at least one. Empty if there is none.
std::string nearest_word(const std::string& typed, const std::vector<std::string>& words);

}  // namespace slalom::tools
