// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "server/picture/block_picture.h"

namespace kerf::paper {

/// One of our pictures beneath a figure of the paper.
struct Figure {
  std::string file;     ///< without ".png"
  std::string place;    ///< of the paper: "Fig. 15 (b)"
  std::string caption;  ///< what is seen
  Picture (*draw)();
};

/// Returns the figures, in the paper's order.
const std::vector<Figure>& figures();

}  // namespace kerf::paper
