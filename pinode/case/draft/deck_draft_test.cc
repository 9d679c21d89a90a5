#include "pinode/case/draft/deck_draft.h"

#include <filesystem>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/temporary_folder_testing.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char kDeck[] =
    "*NODE\n1, 0, 0, 0\n2, 0, 0, 3\n3, 4, 0, 3\n"
    "*ELEMENT, TYPE=B31, ELSET=columns\n1, 1, 2\n"
    "*ELEMENT, TYPE=B31, ELSET=beams\n2, 2, 3\n";

TEST(DeckDraftTest, ExportsBesideTheDeck) {
  TemporaryFolder folder;
  const std::string deck = folder.Write("frame.inp", kDeck);
  for (const char* name :
       {"frame.sti.gz", "frame.mas", "frame.dof", "columns.sti.gz", "beams.mas",
        "mass_columns.mas.gz", "roof.sti", "log.csv"}) {
    folder.Write(name, "");
  }
  DeckModel model;
  std::string error;
  ASSERT_TRUE(FindDeckModel(deck, &model, &error)) << error;
  EXPECT_EQ(model.stiffness, folder.Path("frame.sti.gz"));
  EXPECT_EQ(model.mass, folder.Path("frame.mas"));
  ASSERT_EQ(model.groups.size(), 3u);
  EXPECT_EQ(model.groups[0].name, "beams");
  EXPECT_TRUE(model.groups[0].is_mass);
  EXPECT_EQ(model.groups[1].name, "columns");
  EXPECT_FALSE(model.groups[1].is_mass);
  EXPECT_EQ(model.groups[2].name, "mass_columns");
  EXPECT_EQ(model.groups[2].set, "columns");
  EXPECT_THAT(model.left_out, ElementsAre(folder.Path("roof.sti")));
  EXPECT_TRUE(model.HasTranslation("3.2"));
  EXPECT_FALSE(model.HasTranslation("3.4"));
  EXPECT_FALSE(model.HasTranslation("4.1"));
  EXPECT_FALSE(model.HasTranslation("3"));
}

TEST(DeckDraftTest, ExportsOfPython) {
  TemporaryFolder folder;
  const std::string deck = folder.Write("frame.inp", kDeck);
  std::filesystem::create_directory(folder.Path("frame_export"));
  for (const char* name : {"model.sti", "model.mas", "columns.sti"}) {
    folder.Write(std::string("frame_export/") + name, "");
  }
  DeckModel model;
  std::string error;
  ASSERT_TRUE(FindDeckModel(deck, &model, &error)) << error;
  EXPECT_EQ(model.mass, folder.Path("frame_export/model.mas"));
  ASSERT_EQ(model.groups.size(), 1u);
  EXPECT_EQ(model.groups[0].file, folder.Path("frame_export/columns.sti"));
}

TEST(DeckDraftTest, SaysWhatIsMissing) {
  TemporaryFolder folder;
  const std::string deck = folder.Write("frame.inp", kDeck);
  DeckModel model;
  std::string error;
  EXPECT_FALSE(FindDeckModel(folder.Path("none.inp"), &model, &error));
  EXPECT_THAT(error, HasSubstr("none.inp"));
  EXPECT_FALSE(FindDeckModel(deck, &model, &error));
  EXPECT_THAT(error, HasSubstr("no matrices frame.sti and frame.mas"));
  folder.Write("frame.sti", "");
  EXPECT_FALSE(FindDeckModel(deck, &model, &error));
  folder.Write("frame.mas", "");
  EXPECT_FALSE(FindDeckModel(deck, &model, &error));
  EXPECT_THAT(error, HasSubstr("with a changed property of an element set"));
  EXPECT_TRUE(model.groups.empty());
}

}  // namespace
}  // namespace pinode
