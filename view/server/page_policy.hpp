#pragma once

#include <string>
#include <string_view>

#include "view/server/server.hpp"

namespace slalom::view {

/// The content security policy that a page declares in its head (`http-equiv`), which the build of the page
/// writes. Throws std::invalid_argument if it declares none.
std::string page_policy(std::string_view html);

/// A page as a resource: `html` is the page, `compressed` the same with gzip, or empty. The server sends the
/// policy of the page as a header too. Throws as `page_policy`.
Resource page_resource(std::string html, std::string compressed = "");

}  // namespace slalom::view
