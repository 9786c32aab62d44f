// SPDX-License-Identifier: Apache-2.0
#include "server/formats/heidenhain/flow.h"

#include <utility>

#include "server/formats/letter_case.h"

namespace kerf {
namespace {

constexpr std::size_t kCallsMax = 19;  // as on the TNC 640
/// A block longer than this counts as several towards the limit.
constexpr std::size_t kBlockBytes = 200;
constexpr int kRepeatsMax = 65'534;

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(' ');
  const auto last = text.find_last_not_of(' ');
  return first == std::string::npos ? std::string() : text.substr(first, last - first + 1);
}

}  // namespace

const KlartextBlock* KlartextFlow::next() {
  if (next_ >= blocks_.size()) return nullptr;
  current_ = next_++;
  block_ = current_ == following_ && current_ > 0 ? std::move(following_block_) : blocks_[current_];
  following_ = 0;
  executed_ += 1 + block_.text.size() / kBlockBytes;
  if (executed_ > executed_max_)
    throw ProgramFault{
        "", "the program executes more than " + std::to_string(executed_max_) + " blocks"};
  return &block_;
}

const std::string& KlartextFlow::following() const {
  static const std::string kNone;
  if (next_ >= blocks_.size()) return kNone;
  if (following_ != next_) {
    following_block_ = blocks_[next_];
    following_ = next_;
  }
  return following_block_.text;
}

bool KlartextFlow::execute() {
  const std::string& text = block_.text;
  if (text.starts_with("LBL")) {
    if (trimmed(text.substr(3)) == "0" && !returns_.empty()) {
      next_ = returns_.back();
      returns_.pop_back();
    }
    return true;
  }
  if (text.starts_with("CALL LBL")) return call(trimmed(text.substr(8))), true;
  if (text.starts_with("FN")) return function(text);
  return values_.assign(text);
}

// "5", "5 REP 3/3", "5 REP3".
void KlartextFlow::call(const std::string& rest) {
  const std::size_t rep = rest.find("REP");
  const std::string label = trimmed(rest.substr(0, rep));
  if (rep == std::string::npos) {
    if (returns_.size() >= kCallsMax)
      throw ProgramFault{"CALL LBL", "is nested deeper than " + std::to_string(kCallsMax)};
    returns_.push_back(next_);
    return jump(label);
  }
  const std::string count = trimmed(rest.substr(rep + 3));
  const double times = values_.of(trimmed(count.substr(0, count.find('/'))));
  if (!(times >= 0 && times <= kRepeatsMax))
    throw ProgramFault{"REP", "must be from 0 to " + std::to_string(kRepeatsMax)};
  int& done = repeats_[current_];
  if (done >= static_cast<int>(times)) {
    done = 0;
    return;
  }
  ++done;
  jump(label);
}

void KlartextFlow::jump(const std::string& label) {
  const auto block = blocks_.label(label);
  if (!block) throw ProgramFault{label, "is a label that does not exist"};
  next_ = *block;
}

// FN 0 to FN 8 assign, FN 9 to FN 12 jump.
bool KlartextFlow::function(const std::string& text) {
  const std::size_t colon = text.find(':');
  const std::string number = trimmed(text.substr(2, colon == std::string::npos ? 0 : colon - 2));
  if (number.empty() || number.size() > 2 || !is_digit(number.back()) || !is_digit(number.front()))
    throw ProgramFault{text.substr(0, colon), "is not a function"};
  const int code = std::stoi(number);
  const std::string rest = trimmed(text.substr(colon + 1));
  if (code <= 8) {
    if (!values_.assign(rest)) throw ProgramFault{rest, "is not an assignment"};
    return true;
  }
  if (code <= 12) return jump_if(rest), true;
  if (code == 15 || code == 16 || code == 20) return true;  // prints, waits
  throw ProgramFault{"FN " + number, "is not supported; FN 0 to FN 12 are"};
}

// "IF +Q1 EQU +10 GOTO LBL 5"
void KlartextFlow::jump_if(const std::string& text) {
  struct Test {
    const char* word;
    bool (*holds)(double, double);
  };
  static constexpr Test kTests[] = {{" EQU ", [](double a, double b) { return a == b; }},
                                    {" NE ", [](double a, double b) { return a != b; }},
                                    {" GT ", [](double a, double b) { return a > b; }},
                                    {" LT ", [](double a, double b) { return a < b; }}};
  const std::size_t target = text.find("GOTO LBL");
  if (!text.starts_with("IF") || target == std::string::npos)
    throw ProgramFault{text, "must be IF … EQU, NE, GT or LT … GOTO LBL …"};
  const std::string condition = text.substr(2, target - 2);
  for (const Test& test : kTests) {
    const std::size_t at = condition.find(test.word);
    if (at == std::string::npos) continue;
    const double left = values_.formula(condition.substr(0, at));
    const double right = values_.formula(condition.substr(at + std::string(test.word).size()));
    if (test.holds(left, right)) jump(trimmed(text.substr(target + 8)));
    return;
  }
  throw ProgramFault{condition, "must compare with EQU, NE, GT or LT"};
}

}  // namespace kerf
