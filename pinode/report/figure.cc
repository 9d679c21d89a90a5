#include "pinode/report/figure.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "pinode/base/logging.h"
#include "pinode/base/strings.h"
#include "pinode/report/decimate.h"
#include "pinode/report/number_text.h"

namespace pinode {
namespace {

using Role = IdentificationRecord::Role;

// Points per curve, chosen so that no figure exceeds 150 KiB: an SVG takes 15
// bytes a point, and no screen shows more.
constexpr int kHistoryBuckets = 450;
constexpr int kCloseUpBuckets = 200;
constexpr int kMaxLoopSamples = 2000;
constexpr int kMaxModes = 6;
constexpr int kMaxParameters = 40;
constexpr int kMaxPanels = 6;
// Of a known force: fewer in a panel are drawn as dots.
constexpr int kFewSamples = 50;
// A dot takes ten times the bytes of a point on a line.
constexpr int kMaxDots = 900;

constexpr char kMeasuredLine[] = "lc rgb '#aaaaaa' lw 3.6 dt 1";
constexpr char kUpdatedLine[] = "lc rgb '#0072B2' lw 1.3 dt 1";
constexpr char kBandFill[] = "fc rgb '#A6CEE3' fs solid 1.0 noborder";
constexpr char kPriorLine[] = "lc rgb '#E69F00' lw 1.2 dt (6,3)";
constexpr char kTrueLine[] = "lc rgb '#333333' lw 2.6 dt (2,2)";
constexpr char kFaintLine[] = "lc rgb '#999999' lw 0.8 dt 1";
constexpr char kMark[] = "lc rgb '#D55E00'";

std::string Number(double value) { return FormatNumber(value, 7); }

// "time, s", "a1, m/s²".
std::string AxisLabel(const std::string& quantity, const std::string& unit) {
  const std::string text = UnitText(unit);
  return text.empty() ? quantity : quantity + ", " + text;
}

// A gnuplot script that grows.
class Script {
 public:
  Script(const std::string& id, int width, int height) {
    Line("set encoding utf8");
    // `noenhanced`: names with underscores and carets stay as they are.
    Line("set terminal svg noenhanced size " + std::to_string(width) + "," +
         std::to_string(height) +
         " font 'Helvetica,12' background '#ffffff' name '" + id + "'");
    Line("set tics out nomirror scale 0.6");
    Line("set border 3 lc rgb '#555555' lw 0.8");
    Line("set grid lc rgb '#dddddd' lw 0.5 dt 1");
    Line("set key top right horizontal samplen 2 height 0.3");
    Line("set format '%.6g'");
    Line("set xlabel offset 0,0.5");
  }

  void Line(const std::string& line) { text_ += line + "\n"; }

  // One data block per line drawn; returns its name.
  std::string Data(const std::vector<std::vector<double>>& columns) {
    std::string name = "$d" + std::to_string(num_data_++);
    text_ += name + " << EOD\n";
    for (size_t i = 0; i < columns[0].size(); ++i) {
      bool finite = true;
      for (const auto& column : columns) {
        finite = finite && std::isfinite(column[i]);
      }
      // An empty line lifts the pen.
      for (size_t c = 0; finite && c < columns.size(); ++c) {
        text_ += (c > 0 ? " " : "") + Number(columns[c][i]);
      }
      text_ += "\n";
    }
    text_ += "EOD\n";
    return name;
  }

  const std::string& text() const { return text_; }

 private:
  std::string text_;
  int num_data_ = 0;
};

std::string Lines(const std::string& data, const std::string& style,
                  const std::string& title) {
  return data + " using 1:2 with lines " + style +
         (title.empty() ? " notitle" : " title " + GnuplotString(title));
}

std::string Range(const std::string& axis, double low, double high) {
  if (!(high > low)) {
    const double margin = std::max(std::abs(low), 1e-12);
    low -= margin;
    high += margin;
  }
  return "set " + axis + "range [" + Number(low) + ":" + Number(high) + "]";
}

// Smallest interval that holds the finite values, empty at first.
struct Interval {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  bool empty() const { return !(low <= high); }
  double width() const { return high - low; }
  void Add(double value) {
    if (!std::isfinite(value)) return;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  void Add(const Vector& values) {
    for (const double value : values) Add(value);
  }
};

// Room for what was measured and, as far as it does not dwarf that, for what
// was predicted: a prior model may run away.
Interval VerticalRange(const Vector& measured,
                       const std::vector<Vector>& predicted) {
  Interval range;
  range.Add(measured);
  if (range.empty()) range.Add(0.0);
  const double room = std::max(range.width(), 1e-300);
  const double low = range.low - 0.5 * room, high = range.high + 0.5 * room;
  for (const Vector& values : predicted) {
    Interval other;
    other.Add(values);
    if (other.empty()) continue;
    range.Add(std::max(other.low, low));
    range.Add(std::min(other.high, high));
  }
  const double margin = 0.06 * range.width();
  range.Add(range.low - margin);
  range.Add(range.high + margin);
  return range;
}

// Samples [first, first + count) around the largest fluctuation: some six
// periods of the first mode.
void StrongestPart(const ReportInput& input, const Vector& values, double step,
                   int* first, int* count) {
  const int size = static_cast<int>(values.size());
  double mean = 0.0, present = 0.0;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    mean += value;
    present += 1.0;
  }
  mean = present > 0.0 ? mean / present : 0.0;
  int peak = 0;
  double largest = -1.0;
  for (int i = 0; i < size; ++i) {
    if (std::abs(values(i) - mean) > largest) {
      largest = std::abs(values(i) - mean);
      peak = i;
    }
  }
  double wanted = size / 8.0;
  const double hz = input.modes.empty() ? 0.0 : input.modes[0].updated_hz;
  if (hz > 0.0) wanted = 6.0 / (hz * step);
  *count = static_cast<int>(std::clamp(wanted, std::min(60.0, 1.0 * size),
                                       std::max(60.0, size / 3.0)));
  *count = std::min(*count, size);
  // A free decay is seen best after its peak.
  *first = std::clamp(peak - *count / 3, 0, size - *count);
}

// Where a force acts: the middle nine tenths of its energy with as much again
// on both sides, or, of one that goes on for most of the record, an eighth of
// the record around its peak.
void LargestPart(const Vector& force, int* first, int* count) {
  const int size = static_cast<int>(force.size());
  const double energy = force.squaredNorm();
  int from = 0, to = size - 1, peak = 0;
  double sum = 0.0;
  for (int i = 0; i < size; ++i) {
    if (std::abs(force[i]) > std::abs(force[peak])) peak = i;
    if (sum < 0.05 * energy) from = i;
    if (sum < 0.95 * energy) to = i;
    sum += force[i] * force[i];
  }
  const int length = to - from + 1;
  const bool short_one = length < size / 3;
  *count = std::min(size, std::max(short_one ? 3 * length : size / 8, 40));
  const int middle = short_one ? (from + to) / 2 : peak;
  *first = std::clamp(middle - *count / 2, 0, size - *count);
}

// "record 'quake' (hold-out)".
std::string RecordWithRole(const ReportInput& input, int record) {
  const IdentificationRecord& data =
      input.problem->records[static_cast<size_t>(record)];
  return "record '" + data.name + "' (" +
         (data.role == Role::kTrain ? "training" : "hold-out") + ")";
}

// Springs say everything in their force-deformation loop.
bool DependsOnRate(const RestoringForceLoop& loop) {
  static const std::set<std::string> kSprings = {"cubic", "quadratic_stiffness",
                                                 "bilinear", "bouc_wen"};
  return kSprings.count(loop.type) == 0;
}

// Normalised to a largest entry of one, turned to agree with `like`.
Vector NormalisedShape(const Vector& shape, const Vector& like) {
  const double largest = shape.cwiseAbs().maxCoeff();
  if (!(largest > 0.0)) return shape;
  const double sign = shape.dot(like) < 0.0 ? -1.0 : 1.0;
  return shape * (sign / largest);
}

// Change of a parameter and its 95 % limits in per cent; false where there is
// no natural scale.
bool RelativeChange(const ParameterEstimate& parameter, bool is_group,
                    double* change, double* low, double* high) {
  double scale = std::abs(parameter.initial);
  if (is_group) {
    scale = 1.0;
  } else if (!(scale > 0.0)) {
    return false;
  }
  *change = 100.0 * (parameter.value - parameter.initial) / scale;
  *low = 100.0 * (parameter.lower95 - parameter.initial) / scale;
  *high = 100.0 * (parameter.upper95 - parameter.initial) / scale;
  return std::isfinite(*change);
}

std::vector<double> Column(const Vector& values) {
  return std::vector<double>(values.data(), values.data() + values.size());
}

// Axes for horizontal bars with intervals, per cent, one row a label from the
// top; the rows' places.
std::vector<double> BeginBars(const std::vector<std::string>& labels,
                              const std::vector<double>& changes,
                              const std::vector<double>& lows,
                              const std::vector<double>& highs,
                              Script* script) {
  const int count = static_cast<int>(labels.size());
  std::vector<std::string> ticks;
  std::vector<double> places;
  for (int i = 0; i < count; ++i) {
    places.push_back(count - i);
    ticks.push_back(GnuplotString(labels[static_cast<size_t>(i)]) + " " +
                    std::to_string(count - i));
  }
  // Bars of bad parameters may be cut, changes may not.
  Interval range;
  range.Add(0.0);
  for (const double change : changes) range.Add(change);
  const double room = std::max(2.0 * range.width(), 1e-9);
  const double low_limit = range.low - room, high_limit = range.high + room;
  for (int i = 0; i < count; ++i) {
    range.Add(std::max(lows[static_cast<size_t>(i)], low_limit));
    range.Add(std::min(highs[static_cast<size_t>(i)], high_limit));
  }
  const double margin = std::max(0.08 * range.width(), 1e-9);
  script->Line("unset key");
  script->Line("set ytics (" + Join(ticks, ", ") + ")");
  script->Line(Range("y", 0.4, count + 0.6));
  script->Line(Range("x", range.low - margin, range.high + margin));
  script->Line("set xlabel 'change, %'");
  script->Line(std::string("set arrow from 0, graph 0 to 0, graph 1 nohead ") +
               "lc rgb '#222222' lw 0.8");
  return places;
}

// Red, green and blue of a probability: grey where a loss is out of the
// question, over orange to vermilion where it is certain.
std::array<double, 3> ColourOf(double probability) {
  const double p = std::isfinite(probability) ? probability : 0.0;
  const double none[] = {190.0, 190.0, 190.0};
  const double half[] = {240.0, 180.0, 60.0};
  const double certain[] = {213.0, 40.0, 0.0};
  std::array<double, 3> colour;
  for (size_t k = 0; k < 3; ++k) {
    colour[k] = std::round(p < 0.5 ? none[k] + 2.0 * p * (half[k] - none[k])
                                   : half[k] + (2.0 * p - 1.0) *
                                                   (certain[k] - half[k]));
  }
  return colour;
}

}  // namespace

Figure MakeChannelFigure(const ReportInput& input, int record, int channel) {
  Figure figure;
  const size_t r = static_cast<size_t>(record);
  const IdentificationRecord& data = input.problem->records.at(r);
  const MeasuredChannel& measured =
      data.channels.at(static_cast<size_t>(channel));
  if (r >= input.summary->records.size()) return figure;
  const RecordScore& score = input.summary->records[r];
  const int samples = data.num_samples();
  if (score.prediction.rows() <= channel ||
      score.prediction.cols() != samples || samples < 2) {
    return figure;
  }
  Vector time(samples);
  for (int i = 0; i < samples; ++i) time(i) = data.excitation->time(i);
  const Vector updated = score.prediction.row(channel);
  Vector prior;
  if (r < input.records.size() &&
      input.records[r].prior_prediction.rows() > channel &&
      input.records[r].prior_prediction.cols() == samples) {
    prior = input.records[r].prior_prediction.row(channel);
  }
  const Vector residual = measured.values - updated;
  int first, count;
  StrongestPart(input, measured.values, data.sampling_step(), &first, &count);

  figure.id =
      "channel_" + std::to_string(record) + "_" + std::to_string(channel);
  const std::string& name = measured.observation.name;
  const std::string unit = ChannelUnit(input, record, channel);
  const std::string time_label = AxisLabel("time", input.units.time);
  Script script(figure.id, 900, 400);
  script.Line("set multiplot");
  script.Line("set lmargin at screen 0.085");
  script.Line("set rmargin at screen 0.985");
  script.Line("set tmargin at screen 0.925");
  script.Line("set bmargin at screen 0.575");
  script.Line("set key at screen 0.985,0.985");
  script.Line("set ylabel " + GnuplotString(AxisLabel(name, unit)));

  // Prior first, so that it lies below what matters more.
  const auto add_curves = [&](int from, int size, int buckets, bool titles) {
    std::vector<std::string> curves;
    const Vector t = time.segment(from, size);
    const auto add = [&](const Vector& values, const char* style,
                         const char* title) {
      const Polyline line =
          DecimateHistory(t, values.segment(from, size), buckets);
      if (line.x.empty()) return;
      curves.push_back(
          Lines(script.Data({line.x, line.y}), style, titles ? title : ""));
    };
    if (prior.size() > 0) add(prior, kPriorLine, "prior model");
    add(measured.values, kMeasuredLine, "measured");
    add(updated, kUpdatedLine, "updated model");
    return curves;
  };
  const auto plot = [&](const std::vector<std::string>& curves) {
    // Nothing finite to show still gets its axes.
    script.Line(curves.empty() ? "plot NaN notitle"
                               : "plot " + Join(curves, ", "));
  };

  std::vector<Vector> predictions = {updated};
  if (prior.size() > 0) predictions.push_back(prior);
  const Interval range = VerticalRange(measured.values, predictions);
  const std::string vertical = Range("y", range.low, range.high);
  script.Line(vertical);
  script.Line(Range("x", time(0), time(samples - 1)));
  std::vector<std::string> curves =
      add_curves(0, samples, kHistoryBuckets, true);
  if (score.first_scored_sample > 0 && score.first_scored_sample < samples) {
    const std::string at = Number(time(score.first_scored_sample));
    script.Line("set arrow 1 from " + at + ", graph 0 to " + at +
                ", graph 1 nohead " + kFaintLine);
    script.Line("set label 1 ' scored from here' at " + at +
                ", graph 0.04 tc rgb '#555555'");
  }
  plot(curves);
  script.Line("unset arrow");
  script.Line("unset label");

  script.Line("unset key");
  script.Line("set rmargin at screen 0.49");
  script.Line("set tmargin at screen 0.49");
  script.Line("set bmargin at screen 0.145");
  script.Line("set xlabel " + GnuplotString(time_label));
  script.Line(Range("x", time(first), time(first + count - 1)));
  plot(add_curves(first, count, kCloseUpBuckets, false));

  script.Line("set lmargin at screen 0.6");
  script.Line("set rmargin at screen 0.985");
  script.Line("set ylabel " + GnuplotString(AxisLabel("residual", unit)));
  script.Line(Range("x", time(0), time(samples - 1)));
  const double sigma = channel < static_cast<int>(score.channels.size())
                           ? score.channels[static_cast<size_t>(channel)].sigma
                           : 0.0;
  Interval residual_range;
  residual_range.Add(residual);
  residual_range.Add(2.5 * sigma);
  residual_range.Add(-2.5 * sigma);
  script.Line(Range("y", residual_range.low, residual_range.high));
  curves.clear();
  const Polyline line = DecimateHistory(time, residual, kHistoryBuckets);
  if (!line.x.empty()) {
    curves.push_back(Lines(script.Data({line.x, line.y}), kUpdatedLine, ""));
  }
  const bool has_sigma = std::isfinite(sigma) && sigma > 0.0;
  if (has_sigma) {
    for (const double side : {-2.0 * sigma, 2.0 * sigma}) {
      curves.push_back(Number(side) + " with lines " + kMark +
                       " lw 1 dt (3,3) notitle");
    }
  }
  plot(curves);
  script.Line("unset multiplot");
  figure.script = script.text();

  figure.caption = name + " in " + RecordWithRole(input, record);
  if (channel < static_cast<int>(score.channels.size())) {
    const ChannelScore& scored = score.channels[static_cast<size_t>(channel)];
    figure.caption += ", error " + ReadableNumber(100.0 * scored.nrmse, 3) +
                      " %, prior model " +
                      ReadableNumber(100.0 * scored.prior_nrmse, 3) + " %";
  }
  figure.caption +=
      ". Whole record above; its strongest part below on the left, the "
      "residual "
      "(measured minus updated model) on the right";
  if (has_sigma) figure.caption += ", with \u00b12\u03c3 of the noise dashed";
  figure.caption += ".";
  return figure;
}

Figure MakeLoopFigure(const ReportInput& input, const RestoringForceLoop& loop,
                      int number) {
  Figure figure;
  const int samples = static_cast<int>(loop.force.size());
  if (samples < 2 || !loop.force.allFinite()) return figure;
  const int count = std::min(samples, kMaxLoopSamples);
  Eigen::Index peak;
  loop.deformation.cwiseAbs().maxCoeff(&peak);
  const int first =
      std::clamp(static_cast<int>(peak) - count / 2, 0, samples - count);

  figure.id = "loop_" + std::to_string(number);
  const bool two_panels = DependsOnRate(loop) && loop.rate.size() == samples;
  figure.half_width = !two_panels;
  Script script(figure.id, two_panels ? 900 : 440, 300);
  if (loop.known == nullptr) {
    script.Line("unset key");
  } else {
    // Above the first panel.
    script.Line("set key at screen " +
                std::string(two_panels ? "0.48" : "0.96") + ",0.99 horizontal");
  }
  script.Line("set multiplot layout 1," + std::string(two_panels ? "2" : "1") +
              " margins " + (two_panels ? "0.1,0.975" : "0.19,0.96") + ",0.2," +
              std::string(loop.known != nullptr ? "0.89" : "0.95") +
              " spacing 0.12,0.1");
  const std::string quantity = loop.is_acceleration ? "acceleration" : "force";
  script.Line("set ylabel " +
              GnuplotString(AxisLabel(quantity, loop.force_unit)));
  const Vector force = loop.force.segment(first, count);
  const auto plot = [&](const Vector& abscissa, const std::string& label,
                        const std::string& unit) {
    script.Line("set xlabel " + GnuplotString(AxisLabel(label, unit)));
    const std::string data =
        script.Data({Column(abscissa.segment(first, count)), Column(force)});
    const bool beside_known =
        loop.known != nullptr && &abscissa == &loop.deformation;
    std::string lines;
    if (beside_known) {
      // Where the structure went, and not far beyond.
      const double low = abscissa.minCoeff(), high = abscissa.maxCoeff();
      const double margin = 0.05 * (high - low);
      script.Line(Range("x", low - margin, high + margin));
      lines = Lines(script.Data({Column(loop.known->deformation),
                                 Column(loop.known->force)}),
                    kMeasuredLine, loop.known->name) +
              ", ";
    }
    script.Line("plot " + lines +
                Lines(data, "lc rgb '#0072B2' lw 0.9 dt 1",
                      beside_known ? "identified" : std::string()));
    script.Line("set autoscale x");
  };
  plot(loop.deformation, loop.deformation_name, loop.deformation_unit);
  if (two_panels) plot(loop.rate, loop.rate_name, loop.rate_unit);
  script.Line("unset multiplot");
  figure.script = script.text();

  std::string type = loop.type;
  std::replace(type.begin(), type.end(), '_', '-');
  figure.caption = loop.term + " (" + type + ")";
  if (!loop.output.empty()) figure.caption += ", " + loop.output;
  figure.caption += loop.is_acceleration
                        ? ": acceleration that the network adds, along "
                        : ": resisting force along ";
  figure.caption += RecordWithRole(input, loop.record);
  if (count < samples) {
    figure.caption += ", " + ReadableNumber(loop.time(first), 4) + " to " +
                      ReadableNumber(loop.time(first + count - 1), 4) + " " +
                      input.units.time;
  }
  figure.caption += ".";
  return figure;
}

Figure MakeEquationFigure(const ReportEquation& equation, int number) {
  Figure figure;
  const int samples = static_cast<int>(equation.source_values.size());
  const int panels =
      std::min(static_cast<int>(equation.features.size()), kMaxPanels);
  if (samples < 2 || panels == 0 ||
      equation.equation_values.size() != samples) {
    return figure;
  }
  figure.id = "equation_" + std::to_string(number);
  const int columns = std::min(panels, 2);
  const int rows = (panels + 1) / 2;
  figure.half_width = columns == 1;
  Script script(figure.id, columns == 1 ? 440 : 900, 280 * rows);
  script.Line("unset key");
  script.Line("set multiplot layout " + std::to_string(rows) + "," +
              std::to_string(columns) + " margins " +
              (columns == 1 ? "0.19,0.96" : "0.1,0.975") + "," +
              (rows == 1 ? "0.2" : "0.11") + ",0.96 spacing 0.12,0.16");
  script.Line("set ylabel " +
              GnuplotString(AxisLabel(equation.output, equation.unit)));
  // Two dots a sample and panel.
  const int most = kMaxDots / (2 * panels);
  const int stride = (samples + most - 1) / most;
  for (int k = 0; k < panels; ++k) {
    const ReportEquation::Axis& axis =
        equation.features[static_cast<size_t>(k)];
    // What depends on other features alone would scatter the dots of a sum.
    std::vector<double> x, regressed, said;
    for (int i = 0; i < samples; i += stride) {
      x.push_back(axis.values[i]);
      said.push_back(axis.part[i]);
      regressed.push_back(equation.source_values[i] -
                          (equation.equation_values[i] - axis.part[i]));
    }
    script.Line("set xlabel " + GnuplotString(AxisLabel(axis.name, axis.unit)));
    const std::string below = script.Data({x, regressed});
    const std::string above = script.Data({x, said});
    script.Line(
        "plot " + below +
        " using 1:2 with points pt 7 ps 0.55 lc rgb '#aaaaaa' notitle, " +
        above + " using 1:2 with points pt 7 ps 0.25 lc rgb '#0072B2' notitle");
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption = equation.output + " over each feature, along the training " +
                   "records: the equation's terms in that feature (blue), and "
                   "what they stand for, " +
                   equation.source + " less the other terms (grey)";
  const int left_out = static_cast<int>(equation.features.size()) - panels;
  if (left_out > 0) {
    figure.caption +=
        "; " + std::to_string(left_out) + " more features are not drawn";
  }
  figure.caption += ".";
  return figure;
}

Figure MakeParetoFigure(const ReportEquation& equation, int number) {
  Figure figure;
  std::vector<double> terms, residuals, chosen, chosen_residual;
  for (const ReportEquation::ParetoPoint& point : equation.pareto) {
    // The axis is logarithmic.
    if (!(point.residual > 0.0) || !std::isfinite(point.residual)) continue;
    terms.push_back(point.num_terms);
    residuals.push_back(point.residual);
    if (point.num_terms == equation.num_regressed_terms) {
      chosen.push_back(point.num_terms);
      chosen_residual.push_back(point.residual);
    }
  }
  if (terms.size() < 2) return figure;
  figure.id = "pareto_" + std::to_string(number);
  figure.half_width = true;
  Script script(figure.id, 440, 280);
  script.Line("unset key");
  script.Line("set margins 10,2,3.5,1");
  script.Line("set logscale y");
  script.Line("set format y '%.0e'");
  script.Line("set xlabel 'number of terms'");
  script.Line("set ylabel 'residual, share of the acceleration'");
  const std::string data = script.Data({terms, residuals});
  std::string plot = "plot " + data +
                     " using 1:2 with linespoints pt 7 ps 0.5 " + kUpdatedLine +
                     " notitle";
  if (!chosen.empty()) {
    const std::string mark = script.Data({chosen, chosen_residual});
    plot += ", " + mark + " using 1:2 with points pt 6 ps 1.6 lw 2 " + kMark +
            " notitle";
  }
  script.Line(plot);
  figure.script = script.text();
  figure.caption = equation.output + ": what the best sets of so many of the " +
                   std::to_string(equation.num_candidates) +
                   " candidates leave over of " + equation.source +
                   (chosen.empty() ? "" : "; circled, what was chosen") + ".";
  return figure;
}

Figure MakeForceFigure(const ReportInput& input, int force) {
  Figure figure;
  const ForceEstimate& estimate =
      input.summary->forces.at(static_cast<size_t>(force));
  const int count = static_cast<int>(estimate.value.size());
  if (count < 2 || !estimate.value.allFinite()) return figure;
  const ReportForceTruth* truth = nullptr;
  for (const ReportForceTruth& other : input.force_truths) {
    if (other.name == estimate.name && other.times.size() > 0) truth = &other;
  }
  int first, part;
  LargestPart(estimate.value, &first, &part);

  figure.id = "force_" + std::to_string(force);
  Script script(figure.id, 900, 300);
  script.Line(
      "set multiplot layout 1,2 margins 0.085,0.985,0.2,0.86 spacing "
      "0.1,0.1");
  script.Line("set xlabel " +
              GnuplotString(AxisLabel("time", input.units.time)));
  script.Line("set ylabel " +
              GnuplotString(AxisLabel("force", input.units.force)));
  std::vector<Vector> others;
  if (estimate.sigma.allFinite()) others = {estimate.lower95, estimate.upper95};
  if (truth != nullptr) others.push_back(truth->values);
  const Interval range = VerticalRange(estimate.value, others);
  script.Line(Range("y", range.low, range.high));
  bool dots = false;
  const auto plot = [&](int from, int size, bool titles) {
    const Vector times = estimate.times.segment(from, size);
    script.Line(Range("x", times[0], times[size - 1]));
    std::vector<std::string> curves;
    if (estimate.sigma.allFinite()) {
      // The widest of neighbouring steps stands for them.
      const int stride = (size + kHistoryBuckets - 1) / kHistoryBuckets;
      std::vector<std::vector<double>> band(3);
      for (int i = 0; i < size; i += stride) {
        const int width = std::min(stride, size - i);
        band[0].push_back(times.segment(i, width).mean());
        band[1].push_back(estimate.lower95.segment(from + i, width).minCoeff());
        band[2].push_back(estimate.upper95.segment(from + i, width).maxCoeff());
      }
      curves.push_back(script.Data(band) + " using 1:2:3 with filledcurves " +
                       kBandFill +
                       (titles ? " title '95 % band'" : " notitle"));
    }
    if (truth != nullptr) {
      const Polyline line =
          DecimateHistory(truth->times, truth->values, 2 * kHistoryBuckets);
      const auto shown = std::count_if(
          truth->times.begin(), truth->times.end(), [&](double time) {
            return times[0] <= time && time <= times[size - 1];
          });
      if (!titles && shown < kFewSamples) {
        // Between its samples a blow is not what a straight line makes of it.
        dots = true;
        curves.push_back(
            script.Data(
                {std::vector<double>(truth->times.begin(), truth->times.end()),
                 std::vector<double>(truth->values.begin(),
                                     truth->values.end())}) +
            " using 1:2 with points pt 7 ps 0.5 lc rgb '#333333' "
            "notitle");
      } else if (!line.x.empty()) {
        curves.push_back(Lines(script.Data({line.x, line.y}), kTrueLine,
                               titles ? "truth" : ""));
      }
    }
    const Polyline line = DecimateHistory(
        times, estimate.value.segment(from, size), kHistoryBuckets);
    curves.push_back(Lines(script.Data({line.x, line.y}), kUpdatedLine,
                           titles ? "identified" : ""));
    script.Line("plot " + Join(curves, ", "));
  };
  script.Line("set key at screen 0.985,0.985");
  plot(0, count, true);
  script.Line("unset key");
  plot(first, part, false);
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption = estimate.name + ", the force identified in " +
                   RecordWithRole(input, estimate.record) +
                   "; on the right where it is largest" +
                   (dots ? ", the dots being the truth at its samples" : "") +
                   ".";
  return figure;
}

Figure MakeChangeFigure(const ReportDamage& damage) {
  Figure figure;
  std::vector<std::string> labels;
  std::vector<double> changes, lows, highs, reds, greens, blues;
  for (const ReportDamage::Change& change : damage.changes) {
    if (static_cast<int>(labels.size()) == kMaxParameters) break;
    if (!change.IsSeen()) continue;
    labels.push_back(change.name);
    changes.push_back(100.0 * change.change);
    lows.push_back(100.0 * change.lower95);
    highs.push_back(100.0 * change.upper95);
    const std::array<double, 3> colour = ColourOf(change.probability);
    reds.push_back(colour[0]);
    greens.push_back(colour[1]);
    blues.push_back(colour[2]);
  }
  if (labels.empty()) return figure;
  figure.id = "changes";
  Script script(figure.id, 900, 80 + 24 * static_cast<int>(labels.size()));
  const std::vector<double> places =
      BeginBars(labels, changes, lows, highs, &script);
  const std::string threshold = FormatNumber(-100.0 * damage.threshold, 6);
  script.Line("set arrow from " + threshold + ", graph 0 to " + threshold +
              ", graph 1 nohead lc rgb '#888888' dt 2 lw 0.8");
  const std::string data =
      script.Data({changes, places, lows, highs, reds, greens, blues});
  script.Line("plot " + data +
              " using (0):2:1:(0):(65536*$5+256*$6+$7) with vectors nohead lc "
              "rgb variable lw "
              "14, " +
              data +
              " using 1:2:3:4 with xerrorbars pt 7 ps 0.6 lc rgb '#222222' "
              "lw 1.4");
  figure.script = script.text();
  figure.caption =
      "Changes since the baseline with 95 % intervals. Colour: probability of "
      "a loss of more than " +
      ReadableNumber(100.0 * damage.threshold, 3) +
      " % (dashed), from grey (none) over orange (a half) to red (certain).";
  if (labels.size() < damage.changes.size()) {
    figure.caption += " The others are in the table.";
  }
  return figure;
}

Figure MakeParameterFigure(const ReportInput& input) {
  Figure figure;
  std::vector<std::string> labels, without_scale;
  std::vector<double> changes, lows, highs;
  bool any_group = false;
  int not_drawn = 0;
  for (const ParameterEstimate& parameter : input.summary->parameters) {
    if (!parameter.free) continue;
    bool is_group = false;
    for (const GroupTerm& group : input.problem->dynamics->groups()) {
      is_group = is_group || group.alpha.name == parameter.name ||
                 group.group.name == parameter.name;
    }
    double change, low, high;
    if (!RelativeChange(parameter, is_group, &change, &low, &high)) {
      without_scale.push_back(parameter.name);
      continue;
    }
    if (static_cast<int>(labels.size()) == kMaxParameters) {
      ++not_drawn;
      continue;
    }
    any_group = any_group || is_group;
    labels.push_back(parameter.name);
    changes.push_back(change);
    // Without an interval there is a point and no bar.
    lows.push_back(std::isfinite(low) ? low : change);
    highs.push_back(std::isfinite(high) ? high : change);
  }
  if (labels.empty()) return figure;

  figure.id = "parameters";
  const int count = static_cast<int>(labels.size());
  Script script(figure.id, 900, 80 + 24 * count);
  const std::vector<double> places =
      BeginBars(labels, changes, lows, highs, &script);
  const std::string data = script.Data({changes, places, lows, highs});
  script.Line("plot " + data +
              " using (0):2:1:(0) with vectors nohead lc rgb '#9cc7e0' lw 9, " +
              data +
              " using 1:2:3:4 with xerrorbars pt 7 ps 0.6 lc rgb '#0072B2' "
              "lw 1.8");
  figure.script = script.text();

  figure.caption =
      "Changes with 95 % intervals, in per cent of the initial value";
  if (any_group) {
    figure.caption += " (groups: of the group's own matrix)";
  }
  figure.caption += ".";
  if (!without_scale.empty()) {
    figure.caption +=
        " Not drawn, because zero initially: " + Join(without_scale, ", ") +
        ".";
  }
  if (not_drawn > 0) {
    figure.caption +=
        " " + Count(not_drawn, "further parameter") + " only in the table.";
  }
  return figure;
}

Figure MakeModeShapeFigure(const ReportInput& input) {
  Figure figure;
  const std::vector<std::string>& dofs =
      input.problem->dynamics->model().dof_names;
  const int num_dofs = static_cast<int>(dofs.size());
  std::vector<int> modes;
  for (size_t m = 0; m < input.modes.size(); ++m) {
    const ReportMode& mode = input.modes[m];
    if (mode.initial_shape.size() == num_dofs &&
        mode.updated_shape.size() == num_dofs &&
        mode.initial_shape.allFinite() && mode.updated_shape.allFinite()) {
      modes.push_back(static_cast<int>(m));
    }
    if (static_cast<int>(modes.size()) == kMaxModes) break;
  }
  if (num_dofs < 2 || modes.empty()) return figure;

  const int count = static_cast<int>(modes.size());
  const int columns = std::min(count, 3);
  const int rows = (count + columns - 1) / columns;
  figure.id = "modes";
  const int width = 300 * columns;
  const int height = 80 + 230 * rows;
  Script script(figure.id, width, height);
  const auto fraction = [](double pixels, int size) {
    return FormatNumber(pixels / size, 5);
  };
  script.Line("set key at screen " + fraction(width - 12.0, width) +
              ", screen " + fraction(height - 8.0, height));
  script.Line("set multiplot layout " + std::to_string(rows) + "," +
              std::to_string(columns) + " margins " + fraction(70, width) +
              "," + fraction(width - 15.0, width) + "," + fraction(35, height) +
              "," + fraction(height - 75.0, height) + " spacing " +
              fraction(75, width) + "," + fraction(60, height));
  std::vector<std::string> ticks;
  std::vector<double> places;
  const int every = (num_dofs + 11) / 12;
  for (int i = 0; i < num_dofs; ++i) {
    places.push_back(i + 1);
    if (i % every == 0) {
      ticks.push_back(GnuplotString(dofs[static_cast<size_t>(i)]) + " " +
                      std::to_string(i + 1));
    }
  }
  script.Line("set ytics (" + Join(ticks, ", ") + ")");
  script.Line(Range("y", 0.5, num_dofs + 0.5));
  script.Line("set xrange [-1.15:1.15]");
  script.Line("set xtics -1, 0.5, 1");
  script.Line("set xzeroaxis");
  for (size_t i = 0; i < modes.size(); ++i) {
    const ReportMode& mode = input.modes[static_cast<size_t>(modes[i])];
    script.Line("set title " +
                GnuplotString("mode " + std::to_string(modes[i] + 1) + ":  " +
                              ReadableNumber(mode.initial_hz, 4) + " \u2192 " +
                              ReadableNumber(mode.updated_hz, 4) + " Hz") +
                " offset 0,-0.5");
    const std::string initial = script.Data(
        {Column(NormalisedShape(mode.initial_shape, mode.updated_shape)),
         places});
    const std::string updated = script.Data(
        {Column(NormalisedShape(mode.updated_shape, mode.updated_shape)),
         places});
    script.Line("plot " + initial + " using 1:2 with linespoints pt 6 ps 0.7 " +
                kPriorLine + (i == 0 ? " title 'initial'" : " notitle") + ", " +
                updated + " using 1:2 with linespoints pt 7 ps 0.5 " +
                kUpdatedLine + (i == 0 ? " title 'updated'" : " notitle"));
    script.Line("unset key");
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption =
      "Mode shapes of the linear part, largest entry one, DOFs in the model's "
      "order.";
  return figure;
}

Figure MakeConvergenceFigure(const ReportInput& input) {
  Figure figure;
  const std::vector<IterationRecord>& iterations = input.summary->iterations;
  if (iterations.size() < 2) return figure;
  std::vector<double> accepted_x, accepted_y, rejected_x, rejected_y;
  Interval range;
  // Ends of the stages on the axis of iterations, and their segment lengths.
  std::vector<double> ends;
  std::vector<int> lengths;
  for (size_t i = 0; i < iterations.size(); ++i) {
    const IterationRecord& iteration = iterations[i];
    if (i > 0 && iteration.stage != iterations[i - 1].stage) {
      ends.push_back(static_cast<double>(i) - 0.5);
      lengths.push_back(iterations[i - 1].segment_samples);
    }
    const bool drawable = std::isfinite(iteration.cost) && iteration.cost > 0.0;
    if (!drawable) continue;
    (iteration.accepted ? accepted_x : rejected_x)
        .push_back(static_cast<double>(i));
    (iteration.accepted ? accepted_y : rejected_y).push_back(iteration.cost);
    range.Add(iteration.cost);
  }
  ends.push_back(static_cast<double>(iterations.size()) - 0.5);
  lengths.push_back(iterations.back().segment_samples);
  if (accepted_x.empty()) return figure;

  std::vector<double> error_x, error_y;
  const std::vector<StageRecord>& stages = input.summary->stages;
  for (size_t s = 0; s < stages.size() && s < ends.size(); ++s) {
    const double error = 100.0 * stages[s].free_run_error;
    if (!std::isfinite(error) || !(error > 0.0)) continue;
    error_x.push_back(ends[s]);
    error_y.push_back(error);
  }

  figure.id = "convergence";
  const bool two_panels = !error_x.empty();
  Script script(figure.id, 900, two_panels ? 380 : 240);
  script.Line("set multiplot layout " + std::string(two_panels ? "2" : "1") +
              ",1 margins 0.085,0.985," + (two_panels ? "0.13" : "0.2") +
              ",0.92 spacing 0.1,0.09");
  script.Line("set logscale y");
  script.Line("set format y '%.3g'");
  script.Line(Range("x", -0.5, static_cast<double>(iterations.size()) - 0.5));
  script.Line("set ylabel 'cost'");
  if (range.high < 10.0 * range.low) {
    script.Line(Range("y", range.low / 2.0, range.high * 2.0));
  }
  double begin = -0.5;
  for (size_t s = 0; s < ends.size(); ++s) {
    if (s + 1 < ends.size()) {
      script.Line("set arrow from " + Number(ends[s]) + ", graph 0 to " +
                  Number(ends[s]) + ", graph 1 nohead lc rgb '#999999' lw 0.8");
    }
    // Short stages have no room for words.
    if (ends[s] - begin > 0.05 * static_cast<double>(iterations.size())) {
      script.Line("set label " + std::to_string(s + 1) + " '" +
                  std::to_string(lengths[s]) + "' at " +
                  Number(0.5 * (begin + ends[s])) +
                  ", graph 1.05 center tc rgb '#555555'");
    }
    begin = ends[s];
  }
  std::string plot = "plot " + script.Data({accepted_x, accepted_y}) +
                     " using 1:2 with linespoints pt 7 ps 0.35 " +
                     kUpdatedLine + " title 'accepted'";
  if (!rejected_x.empty()) {
    plot += ", " + script.Data({rejected_x, rejected_y}) +
            " using 1:2 with points pt 2 ps 0.5 " + kMark + " title 'rejected'";
  }
  // The data blocks come before the line that plots them.
  if (!two_panels) script.Line("set xlabel 'iteration'");
  script.Line(plot);
  if (two_panels) {
    script.Line("unset label");
    script.Line("unset key");
    script.Line("set autoscale y");
    script.Line("set xlabel 'iteration'");
    script.Line("set ylabel 'free-run error, %'");
    Interval errors;
    for (const double error : error_y) errors.Add(error);
    script.Line(Range("y", errors.low / 2.0, errors.high * 4.0));
    const std::string data = script.Data({error_x, error_y});
    script.Line("plot " + data + " using 1:2 with linespoints pt 7 ps 0.7 " +
                kUpdatedLine + ", " + data +
                " using 1:2:(sprintf('%.3g', $2)) with labels offset 0,0.8");
  }
  script.Line("unset multiplot");
  figure.script = script.text();
  figure.caption =
      "Cost over the iterations; vertical lines separate the stages, the "
      "numbers "
      "above are their longest segments in samples. The cost jumps where noise "
      "levels are estimated anew or segments merge.";
  if (two_panels) {
    figure.caption +=
        " Below: error of the free run over the whole training records after "
        "each stage.";
  }
  return figure;
}

namespace {

// Removes everything from `begin` through the next `end`, everywhere.
void RemoveSpans(const std::string& begin, const std::string& end,
                 std::string* text) {
  std::string kept;
  size_t at = 0;
  for (;;) {
    const size_t from = text->find(begin, at);
    const size_t to = from == std::string::npos ? from : text->find(end, from);
    if (to == std::string::npos) break;
    kept.append(*text, at, from - at);
    at = to + end.size();
  }
  kept.append(*text, at, std::string::npos);
  *text = std::move(kept);
}

}  // namespace

bool DrawFigure(const Figure& figure, const GnuplotOptions& options,
                std::string* svg, std::string* error) {
  CHECK(!figure.empty()) << "figure '" << figure.id << "' shows nothing";
  std::string text;
  if (!RunGnuplot(figure.script, options, &text, error)) return false;
  const size_t begin = text.find("<svg");
  const size_t end = text.rfind("</svg>");
  if (begin == std::string::npos || end == std::string::npos || end < begin) {
    *error = "gnuplot did not write an SVG";
    return false;
  }
  text = text.substr(begin, end + 6 - begin);
  // Inside HTML the element needs no namespaces; titles would pop up as the
  // names of gnuplot's plots; its filters are for boxed labels.
  RemoveSpans(" xmlns=\"", "\"\n", &text);
  RemoveSpans(" xmlns:xlink=\"", "\"\n", &text);
  RemoveSpans("<title>", "</title>", &text);
  RemoveSpans("<desc>", "</desc>", &text);
  RemoveSpans("<filter", "</filter>", &text);
  RemoveSpans("<!--", "-->", &text);
  // Blanks in tags, where no reader of HTML expects them.
  ReplaceAll("<polygon fill = '", "<polygon fill='", &text);
  ReplaceAll("' points = '", "' points='", &text);
  // Every figure of a document defines the same marks.
  ReplaceAll("xlink:href='#gp", "href='#" + figure.id + "_gp", &text);
  ReplaceAll(" id='gp", " id='" + figure.id + "_gp", &text);
  ReplaceAll(" id=\"gnuplot_canvas\"", "", &text);
  *svg = std::move(text);
  return true;
}

}  // namespace pinode
