// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace kerf::net {

/// The preview that messengers and other sites show for a link to a session's page.
struct PagePreview {
  std::string title;
  std::string picture_url;  ///< absolute; 960 x 720 pixels
};

/// Returns the page with the preview as Open Graph tags (ogp.me) at the end of its head. A page
/// without a head is returned unchanged.
std::string with_preview(std::string page, const PagePreview& preview);

}  // namespace kerf::net
