// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerf::net {

/// What messengers and other sites show of a link to the page of a session.
struct PagePreview {
  std::string title;
  std::string picture_url;  ///< absolute; 960 x 720 pixels
};

/// Returns the page with the preview as tags of the Open Graph protocol (ogp.me) at the end of its
/// head, or the page as it is if it has none.
std::string with_preview(std::string page, const PagePreview& preview);

}  // namespace kerf::net
