#include "pinode/record/frf/frf_files.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <string_view>
#include <utility>

#include "pinode/base/constants.h"
#include "pinode/base/file.h"
#include "pinode/base/file_text.h"
#include "pinode/base/strings.h"
#include "pinode/record/files/universal_file.h"

namespace pinode {
namespace {

using Complex = std::complex<double>;

// Codes of universal files.
constexpr int kFrf = 4;
constexpr int kCoherence = 6;
constexpr int kDisplacement = 8;
constexpr int kVelocity = 11;
constexpr int kAcceleration = 12;
constexpr int kReactionForce = 9;
constexpr int kExcitationForce = 13;
constexpr int kFrequency = 18;

Vector LinesOf(const UniversalFunction& f) {
  if (!f.is_even()) return f.abscissa;
  const double last =
      f.abscissa_start + f.abscissa_step * static_cast<double>(f.size() - 1);
  return Vector::LinSpaced(f.size(), f.abscissa_start, last);
}

// Returns the order of the derivative that the axes state, -1: none. *what is
// set if they state no motion per force.
int DerivativeOf(const UniversalFunction& f, std::string* what) {
  const int motion = f.ordinate_axis.type;
  const int load = f.denominator_axis.type;
  if (load != 0 && load != kReactionForce && load != kExcitationForce) {
    *what = "has no force as its reference (denominator type " +
            std::to_string(load) +
            "): a ratio of two motions has no poles of the structure; give "
            "responses per force";
    return -1;
  }
  switch (motion) {
    case kDisplacement:
      return 0;
    case kVelocity:
      return 1;
    case kAcceleration:
      return 2;
    case 0:
    case 1:
      return -1;
    default:
      *what = "is no motion (ordinate type " + std::to_string(motion) +
              "), expected a displacement (8), velocity (11) or acceleration "
              "(12)";
      return -1;
  }
}

// Line of text that states the exponential window; see FormatFrfFile.
constexpr char kWindowText[] = "exponential window ";

// Returns one over the time constant of the window that the texts of the
// function state, in 1 / s; 0: none.
double DecayRateOf(const UniversalFunction& f) {
  for (const std::string& text : f.texts) {
    if (text.rfind(kWindowText, 0) != 0) continue;
    double rate = 0.0;
    const std::string number = text.substr(sizeof(kWindowText) - 1);
    if (ParseDouble(number.substr(0, number.find(' ')), &rate) && rate > 0.0) {
      return rate;
    }
  }
  return 0.0;
}

// Places that are longer than the 10 characters of the format stand in a line
// of text, after these.
constexpr char kResponseText[] = "response ";
constexpr char kReferenceText[] = "reference ";
constexpr size_t kLongestName = 10;

// Returns the place in full. `begin`: kResponseText or kReferenceText.
std::string LongPlace(const UniversalFunction& f, const std::string& begin,
                      const std::string& name, int node, int direction) {
  if (node != 0 || direction != 0) return UniversalPlace(node, direction);
  for (const std::string& text : f.texts) {
    if (text.rfind(begin, 0) != 0) continue;
    const std::string place = text.substr(begin.size());
    // Blanks at the end of a name are lost.
    if (place.size() > kLongestName &&
        StripBlanks(place.substr(0, kLongestName)) == StripBlanks(name)) {
      return place;
    }
  }
  return name;
}

std::string ResponseOf(const UniversalFunction& f) {
  return LongPlace(f, kResponseText, f.response_name, f.response_node,
                   f.response_direction);
}

std::string ReferenceOf(const UniversalFunction& f) {
  return LongPlace(f, kReferenceText, f.reference_name, f.reference_node,
                   f.reference_direction);
}

// Sets name, or node and direction.
void SetUniversalPlace(const std::string& place, std::string* name, int* node,
                       int* direction) {
  if (!ParseUniversalPlace(place, node, direction)) *name = place;
}

bool SamePair(const UniversalFunction& a, const UniversalFunction& b) {
  return ResponseOf(a) == ResponseOf(b) && ReferenceOf(a) == ReferenceOf(b) &&
         a.size() == b.size();
}

// Splits a line at tabs, semicolons or commas, else at blanks.
std::vector<std::string_view> Cells(std::string_view line) {
  for (const char separator : {'\t', ';', ','}) {
    if (line.find(separator) != std::string_view::npos) {
      return Split(line, separator);
    }
  }
  std::vector<std::string_view> cells;
  for (const std::string_view cell : Split(line, ' ')) {
    if (!cell.empty()) cells.push_back(cell);
  }
  return cells;
}

// The numbers of a line. False if one of its cells is no number.
bool Numbers(const std::vector<std::string_view>& cells,
             std::vector<double>* numbers) {
  numbers->clear();
  for (const std::string_view cell : cells) {
    if (cell.empty() && numbers->size() + 1 >= cells.size()) break;
    double value = 0.0;
    if (!ParseDouble(cell, &value)) return false;
    numbers->push_back(value);
  }
  return numbers->size() > 1;
}

// Returns the derivative that units such as "(m/s^2)/N" state; -1: none.
int DerivativeOfUnits(std::string_view header) {
  const auto has = [header](const char* text) {
    return header.find(text) != std::string_view::npos;
  };
  if (has("m/s\xb2") || has("m/s\xc2\xb2") || has("m/s^2") || has("m/s2") ||
      has("g/n")) {
    return 2;
  }
  if (has("m/s")) return 1;
  if (has("m/n") || has("m)(n)")) return 0;
  return -1;
}

class FrfTextReader {
 public:
  FrfTextReader(const std::string& path, FrequencyResponse* response,
                std::vector<std::string>* remarks, std::string* error)
      : path_(path), one_(*response), remarks_(*remarks), error_(error) {}

  bool Read(std::string_view text) {
    while (!text.empty()) {
      const size_t end = text.find('\n');
      const std::string_view line = StripBlanks(text.substr(0, end));
      text = end == std::string_view::npos ? std::string_view()
                                           : text.substr(end + 1);
      ++line_;
      if (line.empty() || line.front() == '#') continue;
      if (!TakeLine(line)) return false;
    }
    if (rows_.empty()) {
      return Fail(0,
                  "has no lines of numbers, expected a frequency response "
                  "function");
    }
    return Fill();
  }

 private:
  bool Fail(int line, const std::string& what) {
    *error_ =
        path_ + ":" + (line > 0 ? std::to_string(line) + ":" : "") + " " + what;
    return false;
  }

  bool TakeLine(std::string_view line) {
    const std::vector<std::string_view> cells = Cells(line);
    std::vector<double> numbers;
    if (!Numbers(cells, &numbers)) {
      if (!rows_.empty()) {
        return Fail(line_, Quote(line) + " is not a row of numbers");
      }
      return TakeHeader(LowerCase(line));
    }
    if (rows_.empty() && names_.empty()) {
      return Fail(line_,
                  "no header names the columns, expected frequency, and real "
                  "and imaginary or magnitude and phase");
    }
    if (numbers.size() < static_cast<size_t>(needed_)) {
      return Fail(line_, "has " + std::to_string(numbers.size()) +
                             " numbers, expected " + std::to_string(needed_));
    }
    rows_.push_back(std::move(numbers));
    return true;
  }

  // `line` is in lower case.
  bool TakeHeader(const std::string& line) {
    header_ += line + "\n";
    const std::vector<std::string_view> cells = Cells(line);
    if (cells.empty() || cells[0].find("freq") == std::string_view::npos) {
      return true;
    }
    names_.assign(cells.begin(), cells.end());
    // A second header replaces the first.
    real_ = imaginary_ = magnitude_ = phase_ = coherence_ = 0;
    needed_ = 1;
    for (size_t c = 1; c < names_.size(); ++c) {
      const std::string& name = names_[c];
      const auto has = [&name](const char* text) {
        return name.find(text) != std::string::npos;
      };
      int* column = has("real")                 ? &real_
                    : has("imag")               ? &imaginary_
                    : has("mag") || has("ampl") ? &magnitude_
                    : has("phase")              ? &phase_
                    : has("coh")                ? &coherence_
                                                : nullptr;
      if (column == nullptr) continue;
      *column = static_cast<int>(c);
      needed_ = std::max(needed_, static_cast<int>(c) + 1);
    }
    if ((real_ > 0 && imaginary_ > 0) || (magnitude_ > 0 && phase_ > 0)) {
      return true;
    }
    return Fail(line_, "the columns " + Quote(line) +
                           " are not known, expected frequency, and real and "
                           "imaginary or magnitude and phase");
  }

  Vector Column(int column) const {
    Vector values(static_cast<Eigen::Index>(rows_.size()));
    for (size_t i = 0; i < rows_.size(); ++i) {
      values[static_cast<Eigen::Index>(i)] =
          rows_[i][static_cast<size_t>(column)];
    }
    return values;
  }

  bool Fill() {
    one_.file = path_;
    one_.frequencies_hz = Column(0);
    one_.derivative = DerivativeOfUnits(header_);
    if (coherence_ > 0) one_.coherence = Column(coherence_);
    one_.values.resize(one_.frequencies_hz.size());
    if (real_ > 0 && imaginary_ > 0) {
      one_.values.real() = Column(real_);
      one_.values.imag() = Column(imaginary_);
      return true;
    }
    Vector magnitude = Column(magnitude_);
    Vector phase = Column(phase_);
    const bool in_db =
        magnitude.minCoeff() < 0.0 ||
        names_[static_cast<size_t>(magnitude_)].find("db") != std::string::npos;
    const bool in_degrees =
        phase.cwiseAbs().maxCoeff() > 1.001 * kPi ||
        names_[static_cast<size_t>(phase_)].find("deg") != std::string::npos;
    remarks_.push_back(path_ + ": the magnitude is read as " +
                       (in_db ? "dB, with 0 dB for 1 of its unit"
                              : "a ratio, because it is never negative") +
                       ", the phase in " +
                       (in_degrees ? "degrees." : "radians."));
    if (in_db) {
      magnitude = (magnitude.array() * (std::log(10.0) / 20.0)).exp();
    }
    if (in_degrees) phase *= kPi / 180.0;
    for (Eigen::Index k = 0; k < phase.size(); ++k) {
      one_.values[k] = std::polar(magnitude[k], phase[k]);
    }
    return true;
  }

  const std::string& path_;
  FrequencyResponse& one_;
  std::vector<std::string>& remarks_;
  std::string* error_;
  int line_ = 0;
  std::string header_;  // lower case
  std::vector<std::string> names_;
  int real_ = 0, imaginary_ = 0, magnitude_ = 0, phase_ = 0, coherence_ = 0;
  int needed_ = 1;
  std::vector<std::vector<double>> rows_;
};

// Gives the FRFs their places, from those of the options.
bool SetPlaces(const std::string& path, const char* key,
               const std::vector<std::string>& names,
               std::string FrequencyResponse::*place,
               std::vector<FrequencyResponse>* all, std::string* error) {
  if (names.empty()) return true;
  if (names.size() != 1 && names.size() != all->size()) {
    *error = path + ": " + std::to_string(names.size()) + " " + key + " for " +
             std::to_string(all->size()) +
             " frequency response functions, expected one for all or one for "
             "each";
    return false;
  }
  for (size_t i = 0; i < all->size(); ++i) {
    (*all)[i].*place = names[names.size() == 1 ? 0 : i];
  }
  return true;
}

}  // namespace

bool ParseFrfText(const std::string& text, const std::string& path,
                  FrequencyResponse* response,
                  std::vector<std::string>* remarks, std::string* error) {
  return FrfTextReader(path, response, remarks, error).Read(text);
}

bool FrfsOfUniversalFile(const UniversalFile& file, const std::string& path,
                         std::vector<FrequencyResponse>* all,
                         std::string* error) {
  int number = 0;
  std::vector<FrequencyResponse> found;
  for (const UniversalFunction& f : file.functions) {
    ++number;
    if (f.function_type != kFrf) continue;
    std::string what;
    FrequencyResponse one;
    one.file = path;
    one.derivative = DerivativeOf(f, &what);
    if (what.empty() && !f.is_complex) {
      what = "has real values only, expected complex ones";
    }
    if (!what.empty()) {
      *error = path + ": function " + std::to_string(number) + " " + what;
      return false;
    }
    one.response = ResponseOf(f);
    one.reference = ReferenceOf(f);
    one.frequencies_hz = LinesOf(f);
    one.values = f.values;
    one.decay_rate = DecayRateOf(f);
    for (const UniversalFunction& other : file.functions) {
      if (other.function_type == kCoherence && SamePair(f, other)) {
        one.coherence = other.values.real();
      }
    }
    found.push_back(std::move(one));
  }
  if (found.empty()) {
    *error = path +
             ": holds no frequency response function (data set 58, function "
             "type 4); export FRFs, or give time histories as a record";
    return false;
  }
  for (FrequencyResponse& one : found) all->push_back(std::move(one));
  return true;
}

bool ReadFrfFile(const std::string& path, const FrfFileOptions& options,
                 std::vector<FrequencyResponse>* all,
                 std::vector<std::string>* remarks, std::string* error) {
  std::vector<FrequencyResponse> found;
  if (IsUniversalFile(WithoutGz(path))) {
    UniversalFile file;
    if (!ReadUniversalFile(path, &file, error) ||
        !FrfsOfUniversalFile(file, path, &found, error)) {
      return false;
    }
  } else {
    std::string text;
    found.emplace_back();
    if (!ReadTextOfAnyEncoding(path, &text, error) ||
        !ParseFrfText(text, path, &found.back(), remarks, error)) {
      return false;
    }
  }
  if (options.derivative >= 0) {
    for (FrequencyResponse& one : found) one.derivative = options.derivative;
  }
  if (!SetPlaces(path, "responses", options.responses,
                 &FrequencyResponse::response, &found, error) ||
      !SetPlaces(path, "references", options.references,
                 &FrequencyResponse::reference, &found, error)) {
    return false;
  }
  for (FrequencyResponse& one : found) all->push_back(std::move(one));
  return true;
}

std::string FormatFrfFile(const FrequencyResponses& all,
                          const std::string& unit,
                          const std::string& force_unit) {
  const int motions[] = {kDisplacement, kVelocity, kAcceleration};
  UniversalFile file;
  const bool has_coherence = all.coherence.rows() > 0;
  for (Eigen::Index p = 0; p < all.values.cols(); ++p) {
    UniversalFunction f;
    f.texts[0] = FrfQuantityName(all.derivative);
    f.function_type = kFrf;
    f.is_complex = true;
    f.abscissa = all.frequencies_hz;
    f.values = all.values.col(p);
    f.number = static_cast<int>(p) + 1;
    f.abscissa_axis.type = kFrequency;
    f.abscissa_axis.label = "Frequency";
    f.abscissa_axis.unit = "Hz";
    f.ordinate_axis.type = motions[all.derivative];
    f.ordinate_axis.unit = unit;
    f.denominator_axis.type = kExcitationForce;
    f.denominator_axis.unit = force_unit;
    if (all.decay_rate > 0.0) {
      f.texts[3] = kWindowText + FormatNumber(all.decay_rate) + " 1/s";
    }
    const std::string& response =
        all.responses[static_cast<size_t>(p % all.num_responses())];
    const std::string& reference =
        all.references[static_cast<size_t>(p / all.num_responses())];
    SetUniversalPlace(response, &f.response_name, &f.response_node,
                      &f.response_direction);
    SetUniversalPlace(reference, &f.reference_name, &f.reference_node,
                      &f.reference_direction);
    if (f.response_name.size() > kLongestName) {
      f.texts[1] = kResponseText + response;
    }
    if (f.reference_name.size() > kLongestName) {
      f.texts[2] = kReferenceText + reference;
    }
    file.functions.push_back(f);
    if (!has_coherence) continue;
    f.texts[0] = "coherence";
    f.function_type = kCoherence;
    f.is_complex = false;
    f.values = all.coherence.col(p).cast<Complex>();
    file.functions.push_back(std::move(f));
  }
  return FormatUniversalFile(file);
}

}  // namespace pinode
