// Parses the text of a library function with muParser.

#include <muParser.h>
#include <muParserBytecode.h>

#include <charconv>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/dynamics/library_function.h"

namespace pinode {
namespace {

// Largest integer power; std::pow handles larger ones better.
constexpr double kLargestIntegerPower = 64.0;

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

bool BeginsName(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

bool InName(char c) { return BeginsName(c) || IsDigit(c); }

// Returns the character with all its bytes in UTF-8.
std::string CharacterAt(const std::string& text, size_t position) {
  size_t end = position + 1;
  while (end < text.size() && (text[end] & 0xC0) == 0x80) ++end;
  return text.substr(position, end - position);
}

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

// Returns the length of the number at the beginning of `text`, 0 if there is
// none.
size_t NumberLength(const char* begin, const char* end, double* value) {
  if (begin == end || !(IsDigit(*begin) || *begin == '.')) return 0;
  const auto result = std::from_chars(begin, end, *value);
  return result.ec == std::errc() ? static_cast<size_t>(result.ptr - begin) : 0;
}

int ReadNumber(const mu::char_type* text, int* position, double* value) {
  const size_t length =
      NumberLength(text, text + std::char_traits<char>::length(text), value);
  *position += static_cast<int>(length);
  return length > 0 ? 1 : 0;
}

// Functions that muParser would call. Their data distinguish them. A prefix
// operator has no data, and the address of its function distinguishes it. No
// function is evaluated for its value.
double Unary(void*, double x) { return x; }
double Binary(void*, double x, double) { return x; }
double Negative(double x) { return -x; }

}  // namespace

// Builds the list of operations from a text.
class LibraryFunctionBuilder {
 public:
  LibraryFunctionBuilder(const std::string& text,
                         const std::vector<std::string>& feature_names)
      : text_(text), feature_names_(feature_names) {}

  bool Build(LibraryFunction* function, std::string* error);

 private:
  using Code = LibraryFunction::Code;
  using Operation = LibraryFunction::Operation;

  struct NamedCode {
    const char* name;
    Code code;
    int num_arguments;
  };
  static const std::vector<NamedCode>& Functions();
  class Parser;

  // Builds the text for muParser, in which feature i is called "[i]".
  bool Translate();
  // Returns true if text_ at `position` names a feature, with its index and the
  // position behind it.
  bool MatchFeature(size_t position, int* feature, size_t* end) const;
  bool Compile(const mu::ParserByteCode& code);
  bool Push(const Operation& operation);
  bool PushBinary(Code code);
  static bool BinaryCode(mu::ECmdCode token, Code* code);
  // position: position in text_. Both functions return false.
  bool Fail(size_t position, const std::string& message);
  bool FailAs(const mu::ParserError& caught);

  const std::string& text_;
  const std::vector<std::string>& feature_names_;
  std::string error_;

  std::string translated_;
  std::vector<size_t> positions_;  // of each character of translated_ in text_
  std::string canonical_;
  std::vector<double> variables_;

  std::vector<Operation> operations_;
  std::vector<int> stack_;
};

const std::vector<LibraryFunctionBuilder::NamedCode>&
LibraryFunctionBuilder::Functions() {
  static const auto& functions = *new std::vector<NamedCode>{
      {"sin", Code::kSin, 1},   {"cos", Code::kCos, 1},
      {"tan", Code::kTan, 1},   {"asin", Code::kAsin, 1},
      {"acos", Code::kAcos, 1}, {"atan", Code::kAtan, 1},
      {"sinh", Code::kSinh, 1}, {"cosh", Code::kCosh, 1},
      {"tanh", Code::kTanh, 1}, {"exp", Code::kExp, 1},
      {"ln", Code::kLn, 1},     {"log10", Code::kLog10, 1},
      {"sqrt", Code::kSqrt, 1}, {"abs", Code::kAbs, 1},
      {"sign", Code::kSign, 1}, {"min", Code::kMin, 2},
      {"max", Code::kMax, 2},
  };
  return functions;
}

class LibraryFunctionBuilder::Parser : public mu::ParserBase {
 public:
  Parser() {
    DefineNames();
    // Constant folding would remove data that Compile() reads.
    EnableOptimizer(false);
    AddValIdent(ReadNumber);
    DefineConst("pi", kPi);
    DefineInfixOprt("-", Negative);
    for (const NamedCode& function : Functions()) {
      void* data = const_cast<NamedCode*>(&function);
      if (function.num_arguments == 1) {
        DefineFunUserData(function.name, Unary, data);
      } else {
        DefineFunUserData(function.name, Binary, data);
      }
    }
  }

 private:
  void DefineNames() {
    DefineNameChars(
        "0123456789_abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ[]");
    DefineOprtChars("+-*^/?<>=!&|");
    DefineInfixOprtChars("-");
  }
  // Only derived parsers, such as this one, call these functions.
  void InitCharSets() override {}
  void InitFun() override {}
  void InitConst() override {}
  void InitOprt() override {}
};

bool LibraryFunctionBuilder::Fail(size_t position, const std::string& message) {
  error_ = "'" + text_ + "', column " + std::to_string(position + 1) + ": " +
           message;
  return false;
}

bool LibraryFunctionBuilder::MatchFeature(size_t position, int* feature,
                                          size_t* end) const {
  size_t longest = 0;
  for (size_t i = 0; i < feature_names_.size(); ++i) {
    const std::string& name = feature_names_[i];
    size_t at = position;
    size_t matched = 0;
    while (matched < name.size() && at < text_.size()) {
      if (text_[at] == name[matched]) {
        ++matched;
      } else if (matched == 0 || !IsBlank(text_[at])) {
        break;
      }
      ++at;
    }
    // "t" is not the beginning of "tan".
    if (matched < name.size() || (InName(name.back()) && at < text_.size() &&
                                  (InName(text_[at]) || text_[at] == '['))) {
      continue;
    }
    if (matched > longest) {
      longest = matched;
      *feature = static_cast<int>(i);
      *end = at;
    }
  }
  return longest > 0;
}

bool LibraryFunctionBuilder::Translate() {
  const auto append = [this](size_t position, const std::string& characters) {
    translated_ += characters;
    positions_.resize(translated_.size(), position);
  };
  size_t i = 0;
  while (i < text_.size()) {
    const char c = text_[i];
    int feature = -1;
    size_t end = i;
    double number;
    if (IsBlank(c)) {
      append(i++, " ");
    } else if (const size_t length = NumberLength(
                   text_.data() + i, text_.data() + text_.size(), &number)) {
      append(i, text_.substr(i, length));
      canonical_ += text_.substr(i, length);
      i += length;
    } else if (MatchFeature(i, &feature, &end)) {
      append(i, "[" + std::to_string(feature) + "]");
      canonical_ += feature_names_[static_cast<size_t>(feature)];
      i = end;
    } else if (BeginsName(c)) {
      while (end < text_.size() && InName(text_[end])) ++end;
      std::string name = text_.substr(i, end - i);
      if (end < text_.size() && text_[end] == '[') {
        const size_t bracket = text_.find(']', end);
        if (bracket == std::string::npos) {
          return Fail(end, "no ']' belongs to this '['");
        }
        name = text_.substr(i, bracket + 1 - i);
        return Fail(i, "unknown feature '" + name + "'" +
                           NameHint(name, feature_names_));
      }
      bool known = name == "pi";
      std::vector<std::string> names = feature_names_;
      for (const NamedCode& function : Functions()) {
        known = known || name == function.name;
        names.emplace_back(function.name);
      }
      if (!known) {
        return Fail(i, "unknown name '" + name + "'" + NameHint(name, names));
      }
      append(i, name);
      canonical_ += name;
      i = end;
    } else if (std::string_view("+-*/^()<>=!&|?:,").find(c) !=
               std::string_view::npos) {
      append(i++, std::string(1, c));
      canonical_ += c;
    } else {
      return Fail(i, "unexpected character '" + CharacterAt(text_, i) +
                         "', expected features, numbers, functions and "
                         "operators");
    }
    // muParser would join two adjacent names to one.
    if (feature >= 0 && i < text_.size() && InName(text_[i])) {
      return Fail(i, "expected an operator behind a feature");
    }
  }
  return true;
}

bool LibraryFunctionBuilder::Push(const Operation& operation) {
  Operation pushed = operation;
  const auto is_number = [this](int index) {
    return index < 0 ||
           operations_[static_cast<size_t>(index)].code == Code::kNumber;
  };
  const bool fold = pushed.first >= 0 && is_number(pushed.first) &&
                    is_number(pushed.second) && is_number(pushed.third);
  if (fold) {
    std::vector<double> values;
    for (const Operation& earlier : operations_) {
      values.push_back(earlier.number);
    }
    pushed = Operation();
    pushed.number = LibraryFunction::Apply(operation, values.data());
  } else if (pushed.code == Code::kPower && is_number(pushed.second)) {
    const double exponent =
        operations_[static_cast<size_t>(pushed.second)].number;
    if (exponent == std::rint(exponent) &&
        std::abs(exponent) <= kLargestIntegerPower) {
      pushed.code = Code::kIntegerPower;
      pushed.index = static_cast<int>(exponent);
      pushed.second = -1;
    }
  }
  if (operations_.size() >= LibraryFunction::kMaxOperations) {
    return Fail(0, "has more than " +
                       std::to_string(LibraryFunction::kMaxOperations) +
                       " operations, features and numbers");
  }
  operations_.push_back(pushed);
  stack_.push_back(static_cast<int>(operations_.size()) - 1);
  return true;
}

bool LibraryFunctionBuilder::PushBinary(Code code) {
  Operation operation;
  operation.code = code;
  operation.second = stack_.back();
  stack_.pop_back();
  operation.first = stack_.back();
  stack_.pop_back();
  return Push(operation);
}

bool LibraryFunctionBuilder::BinaryCode(mu::ECmdCode token, Code* code) {
  static const auto& codes = *new std::map<mu::ECmdCode, Code>{
      {mu::cmADD, Code::kAdd},         {mu::cmSUB, Code::kSubtract},
      {mu::cmMUL, Code::kMultiply},    {mu::cmDIV, Code::kDivide},
      {mu::cmPOW, Code::kPower},       {mu::cmLT, Code::kLess},
      {mu::cmLE, Code::kLessEqual},    {mu::cmGT, Code::kGreater},
      {mu::cmGE, Code::kGreaterEqual}, {mu::cmEQ, Code::kEqual},
      {mu::cmNEQ, Code::kNotEqual},    {mu::cmLAND, Code::kAnd},
      {mu::cmLOR, Code::kOr},
  };
  const auto found = codes.find(token);
  if (found == codes.end()) return false;
  *code = found->second;
  return true;
}

// Reads the byte code, which is in reverse Polish order. `a ? b : c` is a,
// cmIF, b, cmELSE, c, cmENDIF, so that at cmENDIF all three are on the stack.
bool LibraryFunctionBuilder::Compile(const mu::ParserByteCode& code) {
  for (const mu::SToken* token = code.GetBase(); token->Cmd != mu::cmEND;
       ++token) {
    Operation operation;
    switch (token->Cmd) {
      case mu::cmVAL:
        operation.number = token->Val.data2;
        if (!Push(operation)) return false;
        break;
      case mu::cmVAR:
        operation.code = Code::kFeature;
        operation.index = static_cast<int>(token->Val.ptr - variables_.data());
        if (!Push(operation)) return false;
        break;
      case mu::cmFUNC: {
        if (token->Fun.cb._pUserData == nullptr) {
          operation.code = Code::kNegate;
          operation.first = stack_.back();
          stack_.pop_back();
          if (!Push(operation)) return false;
          break;
        }
        const auto* function =
            static_cast<const NamedCode*>(token->Fun.cb._pUserData);
        if (function->num_arguments == 2) {
          if (!PushBinary(function->code)) return false;
          break;
        }
        operation.code = function->code;
        operation.first = stack_.back();
        stack_.pop_back();
        if (!Push(operation)) return false;
        break;
      }
      case mu::cmENDIF:
        operation.code = Code::kSelect;
        operation.third = stack_.back();
        stack_.pop_back();
        operation.second = stack_.back();
        stack_.pop_back();
        operation.first = stack_.back();
        stack_.pop_back();
        if (!Push(operation)) return false;
        break;
      case mu::cmIF:
      case mu::cmELSE:
        break;
      case mu::cmASSIGN:
        return Fail(text_.find('='), "an assignment, expected '==' to compare");
      default: {
        Code binary;
        if (!BinaryCode(token->Cmd, &binary)) {
          return Fail(0,
                      "holds something that is not in the table of "
                      "pinode/dynamics/library_function.h");
        }
        if (!PushBinary(binary)) return false;
        break;
      }
    }
  }
  return true;
}

// Sets the error to muParser's message in our words, with its place in text_.
bool LibraryFunctionBuilder::FailAs(const mu::ParserError& caught) {
  const size_t position =
      caught.GetPos() >= 0 &&
              static_cast<size_t>(caught.GetPos()) < positions_.size()
          ? positions_[static_cast<size_t>(caught.GetPos())]
          : text_.size();
  const std::string at = position < text_.size()
                             ? "at '" + CharacterAt(text_, position) + "' "
                             : std::string();
  switch (caught.GetCode()) {
    case mu::ecEMPTY_EXPRESSION:
      return Fail(0, "empty, expected an expression");
    case mu::ecUNEXPECTED_EOF:
      return Fail(text_.size(),
                  "ends too early, expected a feature, a number or "
                  "'('");
    case mu::ecMISSING_PARENS:
      return Fail(text_.size(), "ends too early, expected ')'");
    case mu::ecTOO_MANY_PARAMS:
      return Fail(position, "too many arguments of " + caught.GetToken());
    case mu::ecTOO_FEW_PARAMS:
      return Fail(position, "too few arguments of " + caught.GetToken());
    case mu::ecUNEXPECTED_VAL:
    case mu::ecUNEXPECTED_VAR:
    case mu::ecUNEXPECTED_FUN:
      return Fail(position, at + "an operator was expected");
    case mu::ecMISSING_ELSE_CLAUSE:
      return Fail(text_.size(),
                  "ends too early, '?' expects a ':' and a second "
                  "value");
    case mu::ecEXPRESSION_TOO_LONG:
      return Fail(0, "longer than the 10000 characters that muParser reads");
    case mu::ecMISPLACED_COLON:
      return Fail(position, "a ':' without a '?' before it");
    case mu::ecUNASSIGNABLE_TOKEN:
      return Fail(position, at + "an operator was expected, or '(' behind a "
                                 "function");
    default:
      return Fail(position, at + "a feature, a number or '(' was expected");
  }
}

bool LibraryFunctionBuilder::Build(LibraryFunction* function,
                                   std::string* error) {
  error_.clear();
  variables_.assign(feature_names_.size(), 1.0);
  bool built = Translate();
  if (built) {
    try {
      Parser parser;
      for (size_t i = 0; i < variables_.size(); ++i) {
        parser.DefineVar("[" + std::to_string(i) + "]", &variables_[i]);
      }
      parser.SetExpr(translated_);
      // muParser compiles when it evaluates for the first time.
      int num_results = 0;
      parser.Eval(num_results);
      built = num_results == 1
                  ? Compile(parser.GetByteCode())
                  : Fail(canonical_.find(','), "expected one expression");
    } catch (const mu::ParserError& caught) {
      built = FailAs(caught);
    }
  }
  if (!built) {
    if (error != nullptr) *error = error_;
    return false;
  }
  CHECK_EQ(stack_.size(), 1u) << "muParser's byte code of '" << text_ << "'";
  function->text_ = canonical_;
  function->num_features_ = static_cast<int>(feature_names_.size());
  function->operations_ = std::move(operations_);
  function->FindMonomial();
  function->FindSwitches();
  return true;
}

bool LibraryFunction::Parse(const std::string& text,
                            const std::vector<std::string>& feature_names,
                            LibraryFunction* function, std::string* error) {
  CHECK(function != nullptr) << "pass a LibraryFunction to fill";
  for (const std::string& name : feature_names) {
    CHECK(!name.empty()) << "a feature without a name";
  }
  return LibraryFunctionBuilder(text, feature_names).Build(function, error);
}

}  // namespace pinode
