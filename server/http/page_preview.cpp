// SPDX-License-Identifier: Apache-2.0
#include "server/http/page_preview.h"

namespace kerf::net {
namespace {

/// Returns a text as an attribute value in double quotes.
std::string quoted(std::string_view text) {
  std::string html = "\"";
  for (const char c : text) {
    switch (c) {
      case '&':
        html += "&amp;";
        break;
      case '"':
        html += "&quot;";
        break;
      case '<':
        html += "&lt;";
        break;
      default:
        html += c;
    }
  }
  return html + '"';
}

std::string tag(std::string_view property, std::string_view content) {
  return "<meta property=" + quoted(property) + " content=" + quoted(content) + ">\n";
}

}  // namespace

std::string with_preview(std::string page, const PagePreview& preview) {
  const auto end = page.find("</head>");
  if (end == std::string::npos) return page;
  page.insert(end, tag("og:type", "website") + tag("og:site_name", "Kerf") +
                       tag("og:title", preview.title) + tag("og:image", preview.picture_url) +
                       tag("og:image:width", "960") + tag("og:image:height", "720") +
                       tag("twitter:card", "summary_large_image"));
  return page;
}

}  // namespace kerf::net
