#include "pinode/report/gnuplot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <fstream>

namespace pinode {
namespace {

using ::testing::HasSubstr;

bool GnuplotIsThere() {
  std::string output, error;
  return RunGnuplot("set print '-'\nprint 1\n", GnuplotOptions(), &output,
                    &error);
}

// A program of our own in place of gnuplot.
std::string WriteProgram(const std::string& name, const std::string& body) {
  std::string path =
      ::testing::TempDir() + "pinode_" + name + "_" + std::to_string(getpid());
  std::ofstream(path) << "#!/bin/sh\n" << body << "\n";
  chmod(path.c_str(), 0755);
  return path;
}

TEST(GnuplotString, QuotesWhatTheUserWrote) {
  EXPECT_EQ(GnuplotString("a_1"), "'a_1'");
  EXPECT_EQ(GnuplotString("it's"), "'it\u2019s'");
  EXPECT_EQ(GnuplotString("two\nlines\t."), "'two lines .'");
}

TEST(RunGnuplot, SaysThatTheProgramIsMissing) {
  GnuplotOptions options;
  options.program = "/nowhere/gnuplot";
  std::string output = "as before", error;
  EXPECT_FALSE(RunGnuplot("plot x\n", options, &output, &error));
  EXPECT_THAT(error, HasSubstr("'/nowhere/gnuplot' could not be started"));
  EXPECT_EQ(output, "as before");
}

TEST(RunGnuplot, PassesOnTheComplaint) {
  if (!GnuplotIsThere()) GTEST_SKIP() << "gnuplot is not installed";
  std::string output, error;
  EXPECT_FALSE(
      RunGnuplot("plot undefined_name\n", GnuplotOptions(), &output, &error));
  EXPECT_THAT(error, HasSubstr("gnuplot failed"));
  EXPECT_THAT(error, HasSubstr("undefined variable: undefined_name"));
}

TEST(RunGnuplot, ExecutesNothingThatIsQuoted) {
  if (!GnuplotIsThere()) GTEST_SKIP() << "gnuplot is not installed";
  const std::string trace =
      ::testing::TempDir() + "pinode_trace_" + std::to_string(getpid());
  const std::string attacks[] = {
      "`touch " + trace + "`", "'; system('touch " + trace + "'); print '",
      "\"\n!touch " + trace + "\n", "@x `touch " + trace + "` $d0 %s\\"};
  for (const std::string& attack : attacks) {
    std::string output, error;
    EXPECT_TRUE(RunGnuplot(
        "set print '-'\nprint " + GnuplotString(attack) + "\nprint 'end'\n",
        GnuplotOptions(), &output, &error))
        << error;
    EXPECT_THAT(output, HasSubstr("end"));
    EXPECT_NE(access(trace.c_str(), F_OK), 0) << attack;
  }
}

TEST(RunGnuplot, StopsAProgramThatHangs) {
  GnuplotOptions options;
  options.timeout_seconds = 0.3;
  // One keeps its outputs open, the other closes them.
  for (const char* body :
       {"exec sleep 60", "exec >/dev/null 2>&1; exec sleep 60"}) {
    options.program = WriteProgram("hangs", body);
    const auto begin = std::chrono::steady_clock::now();
    std::string output, error;
    EXPECT_FALSE(RunGnuplot("plot x\n", options, &output, &error));
    EXPECT_EQ(error, "gnuplot did not finish in time");
    EXPECT_LT(std::chrono::steady_clock::now() - begin,
              std::chrono::seconds(20));
    std::remove(options.program.c_str());
  }
}

TEST(RunGnuplot, SurvivesAProgramThatDoesNotListen) {
  GnuplotOptions options;
  options.program = WriteProgram("deaf", "echo no >&2; exit 3");
  std::string output, error;
  // More than any buffer between the two holds.
  EXPECT_FALSE(RunGnuplot(std::string(8 << 20, '#'), options, &output, &error));
  EXPECT_EQ(error, "gnuplot failed: no");
  std::remove(options.program.c_str());
}

TEST(RunGnuplot, HandlesMoreThanAPipeHolds) {
  GnuplotOptions options;
  options.program = WriteProgram("echo", "exec cat");
  std::string script, output, error;
  for (int i = 0; i < 300000; ++i) script += std::to_string(i) + "\n";
  ASSERT_TRUE(RunGnuplot(script, options, &output, &error)) << error;
  EXPECT_TRUE(output == script);
  std::remove(options.program.c_str());
}

TEST(RunGnuplot, WantsAnAnswer) {
  GnuplotOptions options;
  options.program = WriteProgram("mute", "cat >/dev/null");
  std::string output, error;
  EXPECT_FALSE(RunGnuplot("plot x\n", options, &output, &error));
  EXPECT_EQ(error, "gnuplot failed");
  std::remove(options.program.c_str());
}

}  // namespace
}  // namespace pinode
