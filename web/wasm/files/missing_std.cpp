// SPDX-License-Identifier: Apache-2.0
#include "web/wasm/files/missing_std.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <string>
#include <string_view>

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

const char* skip_digits(const char* at, const char* last) {
  while (at < last && is_digit(*at)) ++at;
  return at;
}

/// Returns the end of a word that is no number but a value, or `at`.
const char* skip_word(const char* at, const char* last) {
  const auto begins = [&](std::string_view word) {
    if (last - at < static_cast<std::ptrdiff_t>(word.size())) return false;
    for (std::size_t n = 0; n < word.size(); ++n)
      if ((at[n] | 0x20) != word[n]) return false;
    return true;
  };
  for (const std::string_view word : {"infinity", "inf", "nan"})
    if (begins(word)) return at + word.size();
  return at;
}

/// Returns the end of an exponent, or `at`.
const char* skip_exponent(const char* at, const char* last) {
  if (at == last || (*at | 0x20) != 'e') return at;
  const char* digits = at + 1;
  if (digits < last && (*digits == '+' || *digits == '-')) ++digits;
  const char* end = skip_digits(digits, last);
  return end == digits ? at : end;
}

/// Returns the end of the longest beginning that is a number, `first` if there is none.
const char* end_of_number(const char* first, const char* last, std::chars_format format) {
  const char* begin = first < last && *first == '-' ? first + 1 : first;
  if (const char* word = skip_word(begin, last); word != begin) return word;
  const char* end = skip_digits(begin, last);
  std::ptrdiff_t digits = end - begin;
  if (end < last && *end == '.') {
    const char* fraction = skip_digits(end + 1, last);
    digits += fraction - (end + 1);
    end = fraction;
  }
  if (digits == 0) return first;
  const bool may_have_exponent = (format & std::chars_format::scientific) != std::chars_format{};
  const bool may_lack_exponent = (format & std::chars_format::fixed) != std::chars_format{};
  const char* exponent = may_have_exponent ? skip_exponent(end, last) : end;
  return exponent == end && !may_lack_exponent ? first : exponent;
}

template <class T, class Read>
std::from_chars_result read_number(const char* first, const char* last, T& value,
                                   std::chars_format format, const Read& read) {
  const char* end = end_of_number(first, last, format);
  if (end == first) return {first, std::errc::invalid_argument};
  const std::string text(first, end);
  errno = 0;
  const T number = read(text.c_str());
  if (errno == ERANGE && (std::isinf(number) || number == 0))
    return {end, std::errc::result_out_of_range};
  value = number;
  return {end, {}};
}

}  // namespace

std::from_chars_result std::from_chars(const char* first, const char* last, double& value,
                                       chars_format format) {
  return read_number(first, last, value, format,
                     [](const char* text) { return std::strtod(text, nullptr); });
}

std::from_chars_result std::from_chars(const char* first, const char* last, float& value,
                                       chars_format format) {
  return read_number(first, last, value, format,
                     [](const char* text) { return std::strtof(text, nullptr); });
}

bool std::filesystem::is_regular_file(const path& file, std::error_code& error) {
  struct stat about{};
  error = {};
  return ::stat(file.c_str(), &about) == 0 && S_ISREG(about.st_mode);
}

std::uintmax_t std::filesystem::file_size(const path& file, std::error_code& error) {
  struct stat about{};
  const bool is_there = ::stat(file.c_str(), &about) == 0;
  error = is_there ? std::error_code() : std::error_code(errno, std::generic_category());
  return is_there ? static_cast<std::uintmax_t>(about.st_size) : static_cast<std::uintmax_t>(-1);
}

bool std::filesystem::remove(const path& file, std::error_code& error) {
  error = {};
  return ::unlink(file.c_str()) == 0;
}
