// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "kernel/dexel/stock_shape.h"
#include "server/formats/control/fault.h"

namespace kerf {

/// A block of a Klartext program: lines joined by "~", in upper case with single blanks, without
/// block number and comment.
struct KlartextBlock {
  std::string text;
  std::size_t line = 0;  ///< of its first line, from 1
};

/// Most labels of a program: HEIDENHAIN numbers them up to 65,535.
inline constexpr std::size_t kKlartextLabelsMax = 65'536;

/// A program divided into blocks. Stores only their offsets. Structure comments ("* - …"), empty
/// blocks and those with "/" are skipped.
class KlartextBlocks {
 public:
  /// `program` must outlive it. Throws ProgramFault for too many labels.
  explicit KlartextBlocks(std::string_view program);

  std::size_t size() const { return lines_.size(); }
  /// Reads a block. Precondition: n < size().
  KlartextBlock operator[](std::size_t n) const;
  /// The number of the block LBL with this name.
  std::optional<std::size_t> label(const std::string& name) const;
  /// The number of lines of the program.
  std::size_t lines() const { return line_count_; }

 private:
  std::string_view program_;
  std::vector<std::size_t> places_;   ///< of the first line of each block
  std::vector<std::uint32_t> lines_;  ///< its number
  std::map<std::string, std::size_t> labels_;
  std::size_t line_count_ = 0;
};

/// Whether a text is a Klartext program: its first block is BEGIN PGM.
bool is_klartext(std::string_view program);
/// Returns the unit of a Klartext program in mm: 25.4 if its first block ends with INCH, else 1.
double klartext_unit_mm(std::string_view program);

/// A word of a block: letters and the text after them, as "IX" and "+Q5", "F" and "MAX", "DR" and
/// "-". Blanks between sign or name and number belong to no word.
struct KlartextWord {
  std::string name;
  std::string value;  ///< number, Q parameter with its sign, or rest of the name
};

/// Divides "X+10 IY-5.5 R0 FMAX M3" into words. Commas are decimal points.
std::vector<KlartextWord> klartext_words(std::string_view text);

/// Returns the stock of BLK FORM 0.1 and 0.2, in mm, or nullopt if the program has none, or another
/// form of it, or a corner that is not three numbers.
std::optional<StockShape> klartext_blank(std::string_view program);

}  // namespace kerf
