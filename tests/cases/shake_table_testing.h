// Shared by the tests of a small three-storey frame on a shake table, from its
// measured accelerations: trained on the first half of a test, the second half
// and another test held out. The records belong to others and are not part of
// the project; data/README.md says where they come from.

#ifndef PINODE_TESTS_CASES_SHAKE_TABLE_TESTING_H_
#define PINODE_TESTS_CASES_SHAKE_TABLE_TESTING_H_

#include <cmath>
#include <cstdio>
#include <sstream>
#include <string>

#include "gtest/gtest.h"
#include "pinode/structure/model/modal_analysis.h"
#include "tests/cases/measure.h"
#include "tests/support/figure_testing.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace testing {

struct Frame {
  const char* name;
  double duration;       // s
  double sine_duration;  // s
  const char* band;      // Hz
  double storey;         // N/m, a guess
  // Floor masses: blocks of 0.124 kg and the walls' share, kg.
  const char* masses;
  double wall;  // a storey's walls, kg
};

constexpr Frame kStiff = {"stiff",       104.98, 69.9,
                          "[0.8, 50.0]", 1600.0, "[0.2335, 0.2335, 0.1788]",
                          0.1095};
constexpr Frame kFlexible = {"flexible",    100.95, 60.8,
                             "[0.8, 30.0]", 370.0,  "[0.1602, 0.1602, 0.1421]",
                             0.0362};

// A record of a test from `from` to `to`, s.
inline std::string RecordText(const Frame& frame, const char* name,
                              const char* role, const char* file, double from,
                              double to, bool delays) {
  std::ostringstream text;
  text << "[[record]]\nname = \"" << name << "\"\nrole = \"" << role
       << "\"\nfile = \"" << MeasuredData() << "/mini_shake_table/"
       << frame.name << "3story_" << file << ".csv\"\ntime = \"t_s\"\n"
       << "window = [" << from << ", " << to << "]\nstart = \""
       << (from == 0.0 ? "rest" : "free")
       << "\"\ninterpolation = \"cubic\"\nsubsteps = 4\n"
       << "[[record.ground]]\ndirection = \"x\"\ncolumn = \"ground_ax\"\n"
       << "unit = \"m/s^2\"\nremove_offset = true\n";
  for (int s = 1; s <= 3; ++s) {
    text << "[[record.channel]]\nname = \"a" << s << "\"\ncolumn = \"floor" << s
         << "_ax\"\nquantity = \"absolute_acceleration\"\ndof = \"u" << s
         << "\"\nunit = \"m/s^2\"\nremove_offset = true\n";
    if (delays) {
      text << "delay = {initial = 0.0, prior_sigma = 0.002, free = true}\n";
    }
  }
  text << "[record.filter]\ntype = \"bandpass\"\ncorner_hz = " << frame.band
       << "\norder = 4\n";
  return text.str();
}

// Symmetric stiffness and damping: springs and dampers between all pairs of
// points, with weak priors; without, a mode of which the record says little can
// be damped away for good early in the fit. With elements, the walls' mass is
// spread instead of lumped and the sensors need not share one clock.
inline std::string FrameText(const Frame& frame, bool elements) {
  const char* points[] = {"ground", "u1", "u2", "u3"};
  std::ostringstream text;
  text << "[units]\nforce = \"N\"\nlength = \"m\"\ntime = \"s\"\n"
       << "[model]\ndofs = [\"u1\", \"u2\", \"u3\"]\n"
       << "damping = {ratios = [0.01]}\n";
  if (elements) {
    // The consistent mass matrix of a clamped wall couples 9/70 of its mass to
    // the other end.
    text << "support_mass_coupling = {x = [" << 9.0 / 70.0 * frame.wall
         << ", 0, 0]}\n";
  }
  text << "[model.shear_building]\nmasses = " << frame.masses
       << "\nstiffnesses = [" << frame.storey << ", " << frame.storey << ", "
       << frame.storey << "]\n";
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) {
      for (const char* target : {"stiffness", "damping"}) {
        const bool stiffness = target[0] == 's';
        text << "[[group]]\nname = \"" << (stiffness ? "k" : "c") << a << b
             << "\"\nadds_to = \"" << target << "\"\nbetween = [\"" << points[a]
             << "\", \"" << points[b]
             << "\"]\nscale = " << (stiffness ? frame.storey : 1.0)
             << "\nprior_sigma = " << (stiffness ? 1.0 : 3.0) << "\n";
      }
    }
  }
  if (elements) {
    text << "[[group]]\nname = \"m1\"\nadds_to = \"mass\"\n"
         << "between = [\"ground\", \"u1\"]\nscale = 0.2\n"
         << "[[group]]\nname = \"m2\"\nadds_to = \"mass\"\n"
         << "between = [\"ground\", \"u2\"]\nscale = 0.2\n"
         << "[[group]]\nname = \"m12\"\nadds_to = \"mass\"\n"
         << "matrix = [[0, 0.02, 0], [0.02, 0, 0], [0, 0, 0]]\n"
         << "[[group]]\nname = \"m23\"\nadds_to = \"mass\"\n"
         << "matrix = [[0, 0, 0], [0, 0, 0.02], [0, 0.02, 0]]\n";
    for (int s = 1; s <= 3; ++s) {
      const std::string between = std::string("between = [\"") + points[s - 1] +
                                  "\", \"" + points[s] + "\"]\n";
      text << "[[element]]\nname = \"q" << s
           << "\"\ntype = \"quadratic_stiffness\"\n"
           << between << "parameters.k2 = {initial = 0.0}\n"
           << "[[element]]\nname = \"d" << s
           << "\"\ntype = \"amplitude_damping\"\n"
           << between << "parameters.c2 = {initial = 0.0}\n";
    }
  }
  const double half = 0.5 * frame.duration;
  text << RecordText(frame, "first", "train", "northridge", 0.0, half, elements)
       << RecordText(frame, "second", "holdout", "northridge", half,
                     frame.duration, elements)
       << RecordText(frame, "sine", "holdout", "sine_1p5", 0.0,
                     frame.sine_duration, elements);
  return text.str();
}

// Storeys of the stiff frame's model, with Rayleigh's damping, from half a test
// of `frame`.
inline std::string StoreysText(const Frame& frame, bool second_half) {
  std::ostringstream text;
  text << "[units]\nforce = \"N\"\nlength = \"m\"\ntime = \"s\"\n"
       << "[model]\ndamping = {ratios = [0.01]}\n"
       << "[model.shear_building]\nmasses = " << kStiff.masses
       << "\nstiffnesses = [1600.0, 1600.0, 1600.0]\n";
  for (int s = 1; s <= 3; ++s) {
    text << "[[group]]\nname = \"k" << s
         << "\"\nadds_to = \"stiffness\"\nstorey = " << s
         << "\nlower = -0.95\n";
  }
  text << "[[group]]\nname = \"c_mass\"\nadds_to = \"damping\"\nmatrix = "
       << "{diagonal = " << kStiff.masses << "}\n"
       << "[[group]]\nname = \"c_stiffness\"\nadds_to = \"damping\"\n"
       << "matrix = [[0.32, -0.16, 0], [-0.16, 0.32, -0.16], "
       << "[0, -0.16, 0.16]]\n";
  const double half = 0.5 * frame.duration;
  text << RecordText(frame, "half", "train", "northridge",
                     second_half ? half : 0.0,
                     second_half ? frame.duration : half, false);
  return text.str();
}

inline CaseRun RunText(const std::string& name, const std::string& text) {
  const TemporaryFolder folder;
  Case c = ReadCaseOrFail(folder.Write("shake_" + name + ".toml", text));
  c.options.function_tolerance = 1e-6;
  return RunCase(std::move(c));
}

inline CaseRun RunFrame(const Frame& frame, bool elements) {
  return RunText(std::string(frame.name) + (elements ? "_elements" : "_linear"),
                 FrameText(frame, elements));
}

inline void ExpectNrmse(const CaseRun& run, const std::string& what,
                        const char* record, const double (&limits)[3]) {
  for (int c = 0; c < 3; ++c) {
    const ChannelScore& channel =
        run.Record(record).channels[static_cast<size_t>(c)];
    ReportFigure(what + ": nrmse, " + record + ", " + channel.name,
                 AtMost(limits[c]), channel.nrmse);
    EXPECT_LT(channel.nrmse, limits[c]) << record << " " << channel.name;
  }
}

// The second half beside the residual of an independent modal fit in the same
// band.
inline void ExpectNrmseBesideOtherFit(const CaseRun& run,
                                      const std::string& what,
                                      const double (&other)[3]) {
  constexpr double kLimit = 1.1;
  double worst = 0.0;
  for (int c = 0; c < 3; ++c) {
    const ChannelScore& channel =
        run.Record("second").channels[static_cast<size_t>(c)];
    std::printf("second %s: nrmse %.3f, the other fit's %.3f\n",
                channel.name.c_str(), channel.nrmse, other[c]);
    worst = Worse(worst, channel.nrmse / other[c]);
    EXPECT_LT(channel.nrmse, kLimit * other[c]) << channel.name;
  }
  ReportFigure(what + ": nrmse, second, worst floor, in those of another fit",
               AtMost(kLimit), worst);
}

// Nothing is asked of measured records: what the model cannot do there is not
// what it could not do in training.
inline void ReportBands(const CaseRun& run, const std::string& what) {
  for (const RecordScore& record : run.summary.records) {
    for (const ChannelScore& channel : record.channels) {
      ReportFigure(what + ": share within the 95 % band, " + record.name +
                       ", " + channel.name,
                   Asked(), channel.band_coverage);
      EXPECT_TRUE(std::isfinite(channel.band_coverage)) << channel.name;
    }
  }
}

inline ModalProperties ModesOf(const CaseRun& run) {
  const StructuralModel model = run.c.problem.dynamics->CorrectedModel(
      run.model.parameters.head(run.c.problem.dynamics->num_parameters()));
  ModalProperties modes;
  std::string error;
  EXPECT_TRUE(
      ComputeModes(model.mass, model.damping, model.stiffness, &modes, &error))
      << error;
  return modes;
}

inline void ExpectFrequencies(const CaseRun& run, const std::string& what,
                              const double (&lower)[3],
                              const double (&upper)[3]) {
  const ModalProperties modes = ModesOf(run);
  for (int i = 0; i < 3; ++i) {
    std::printf("mode %d: %.3f Hz, damping %.2f %%\n", i + 1,
                modes.frequency_hz[i], 100.0 * modes.damping_ratio[i]);
    ReportFigure(what + ": frequency " + std::to_string(i + 1) + ", Hz",
                 Between(lower[i], upper[i]), modes.frequency_hz[i]);
    EXPECT_GT(modes.frequency_hz[i], lower[i]);
    EXPECT_LT(modes.frequency_hz[i], upper[i]);
  }
}

class ShakeTable : public ::testing::Test {
 protected:
  void SetUp() override {
    if (MeasuredData().empty()) {
      ReportSkipped(
          std::string("case 5, ") +
          ::testing::UnitTest::GetInstance()->current_test_info()->name());
      GTEST_SKIP() << "measured data not at hand; set PINODE_MEASURED_DATA";
    }
  }
};

}  // namespace testing
}  // namespace pinode

#endif  // PINODE_TESTS_CASES_SHAKE_TABLE_TESTING_H_
