#include "pinode/case/results/updated_deck.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "pinode/base/strings.h"
#include "pinode/case/sections/case_file.h"
#include "tests/support/identify_testing.h"
#include "tests/support/rod_case_testing.h"

namespace pinode {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

constexpr char kRodDeck[] =
    "** A rod\n*NODE\n1,0,0,0\n2,1,0,0\n3,2,0,0\n"
    "*ELEMENT,TYPE=SPRINGA,ELSET=lower\n1,1,2\n"
    "*ELEMENT,TYPE=SPRINGA,ELSET=upper\n2,2,3\n"
    "*SPRING,ELSET=lower\n\n100.\n*SPRING,ELSET=upper\n\n200.\n";

class UpdatedDeckTest : public RodCaseTest {
 protected:
  // The deck that a fit with these changes leaves.
  std::string Write(double lower, double upper, bool usable,
                    double brace = 0.0) {
    const Case c = ReadOrFail(case_);
    IdentifiedModel model;
    model.parameters = c.problem.dynamics->Parameters();
    model.parameters << lower, upper, brace;
    IdentificationSummary summary;
    if (usable) summary.verdict = testing::Good();
    const std::string deck = folder_.Write("rod.inp", deck_);
    good_ = CheckDeck(c, deck, &error_) &&
            WriteUpdatedDeck(c, summary, model, deck, out_, &remark_, &error_);
    const bool written = good_ && remark_.rfind("No updated deck", 0) != 0;
    return written ? folder_.Read("rod_updated.inp") : std::string();
  }

  std::string case_ = kRodCase, deck_ = kRodDeck;
  bool good_ = false;
  std::string out_ = folder_.Path("");
  std::string remark_, error_;
};

TEST_F(UpdatedDeckTest, SaysOfWhatFitItIs) {
  const std::string deck = Write(-0.1, 0.0, true);
  EXPECT_THAT(deck, StartsWith("** A rod\n"));
  EXPECT_THAT(deck, HasSubstr("ELSET=lower\n\n9.0000000000000E+01\n"));
  const std::string doubtful = Write(-0.1, 0.0, false);
  EXPECT_THAT(doubtful, StartsWith("** The fit is not usable"));
  EXPECT_EQ(doubtful.substr(doubtful.find('\n') + 1), deck);
}

// The deck cannot hold a spring between two nodes that it does not have,
// whether it has an element set of that name or not.
TEST_F(UpdatedDeckTest, NamesTheGroupsThatItDoesNotHold) {
  const std::string plain = Write(-0.1, 0.0, true);
  EXPECT_THAT(remark_, IsEmpty());
  for (const char* name : {"brace", "stay"}) {
    case_ = Replaced(kRodCase, "\"brace\"", "\"" + std::string(name) + "\"");
    const std::string deck = Write(-0.1, 0.0, true, 0.3);
    EXPECT_THAT(remark_, HasSubstr("does not have the change of '" +
                                   std::string(name) + "'"));
    EXPECT_THAT(deck, StartsWith("** Not in this deck"));
    EXPECT_THAT(deck,
                HasSubstr("\n**   '" + std::string(name) + "'\n** A rod"));
    EXPECT_EQ(deck.substr(deck.find("** A rod")), plain);
  }
  // One that follows time is no constant factor.
  case_ = Replaced(kRodCase, "lower = -0.9",
                   "follows = {time = \"linear\", reference = 0.5}");
  const std::string deck = Write(0.1, 0.2, true);
  EXPECT_THAT(remark_, HasSubstr("'lower'"));
  EXPECT_THAT(deck, HasSubstr("ELSET=lower\n\n100.\n"));
}

TEST_F(UpdatedDeckTest, KeepsLineEndsAndEncodings) {
  const std::string plain = Write(-0.1, 0.0, false, 0.3);
  ReplaceAll("\n", "\r\n", &deck_);
  ReplaceAll("A rod",
             "Stra\xDF"
             "e",
             &deck_);
  std::string deck = Write(-0.1, 0.0, false, 0.3);
  EXPECT_THAT(deck, HasSubstr("\r\n** Stra\xDF"
                              "e\r\n"));
  ReplaceAll("\r\n", "\n", &deck);
  ReplaceAll(
      "Stra\xDF"
      "e",
      "A rod", &deck);
  EXPECT_EQ(deck, plain);
}

TEST_F(UpdatedDeckTest, ALossOfAllIsARemarkOtherTroubleAnError) {
  EXPECT_THAT(Write(-1.0, 0.0, true), IsEmpty());
  EXPECT_TRUE(good_) << error_;
  EXPECT_THAT(remark_, HasSubstr("element set 'lower' is not positive"));
  out_ = folder_.Path("not/there");
  Write(-0.1, 0.0, true);
  EXPECT_FALSE(good_);
  EXPECT_THAT(error_, HasSubstr("not/there"));
  EXPECT_THAT(remark_, IsEmpty());
}

}  // namespace
}  // namespace pinode
