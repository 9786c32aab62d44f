// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/picture/block_picture.h"

namespace kerf::paper {

/// A recreated picture for a figure of the paper.
struct Figure {
  std::string file;     ///< without ".png"
  std::string place;    ///< in the paper: "Fig. 15 (b)"
  std::string caption;  ///< description of the picture
  Picture (*draw)();
};

/// Returns the figures, in the paper's order.
const std::vector<Figure>& figures();

}  // namespace kerf::paper
