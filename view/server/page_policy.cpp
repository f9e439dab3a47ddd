#include "view/server/page_policy.hpp"

#include <stdexcept>
#include <utility>

namespace slalom::view {

std::string page_policy(std::string_view html) {
  constexpr std::string_view declaration = "<meta http-equiv=\"Content-Security-Policy\" content=\"";
  const std::string_view head = html.substr(0, html.find("</head>"));
  const std::size_t found = head.find(declaration);
  const std::size_t begin = found == std::string_view::npos ? found : found + declaration.size();
  const std::size_t end = begin == std::string_view::npos ? begin : head.find('"', begin);
  if (end == std::string_view::npos)
    throw std::invalid_argument("the page declares no content security policy in its head");
  return std::string(head.substr(begin, end - begin));
}

Resource page_resource(std::string html, std::string compressed) {
  Resource resource{.type = "text/html; charset=utf-8", .policy = page_policy(html)};
  if (compressed.empty()) {
    resource.body = std::move(html);
  } else {
    resource.encoding = "gzip";
    resource.body = std::move(compressed);
    resource.plain = std::move(html);
  }
  return resource;
}

}  // namespace slalom::view
