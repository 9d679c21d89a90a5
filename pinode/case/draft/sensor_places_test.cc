#include "pinode/case/draft/sensor_places.h"

#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace pinode {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<int> Places(const std::vector<std::string>& names, int storeys) {
  return FindPlacesByName(names, storeys).places;
}

TEST(SensorPlacesTest, NamesOfFloors) {
  EXPECT_THAT(Places({"Boden", "Etage 1", "Etage 2", "Dach"}, 3),
              ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(Places({"CH0 Base X", "CH1 3. OG", "CH2 2. Stock"}, 5),
              ElementsAre(0, 3, 2));
  EXPECT_THAT(Places({"2e \xC3\xA9tage", "ground", "1er etage"}, 2),
              ElementsAre(2, 0, 1));
  EXPECT_THAT(Places({"acc_base", "acc_1", "acc_2"}, 2), ElementsAre(0, 1, 2));
  EXPECT_THAT(Places({"a3", "a1", "a2"}, 3), ElementsAre(3, 1, 2));
  EXPECT_THAT(Places({"acc0", "acc1", "acc2"}, 2), ElementsAre(0, 1, 2));
  EXPECT_THAT(Places({"floor1", "floor4", "roof"}, 6), ElementsAre(1, 4, 6));
}

// An American second floor is the first one above the ground.
TEST(SensorPlacesTest, FloorsThatMayBeCountedFromTheGround) {
  for (const std::vector<std::string>& names :
       {std::vector<std::string>{"base", "floor 2", "floor 3"},
        {"base", "2nd floor", "3rd floor"},
        {"base", "level 1", "level 4"}}) {
    const PlacesByName found = FindPlacesByName(names, 3);
    EXPECT_EQ(found.places[0], 0);
    EXPECT_EQ(found.places[1], kPlaceUnclear) << names[1];
    EXPECT_THAT(found.doubt, HasSubstr("may count from the ground"));
  }
}

TEST(SensorPlacesTest, NumbersThatAreNotFloors) {
  for (const std::vector<std::string>& names :
       {// Three sensors in four storeys.
        std::vector<std::string>{"acc_1", "acc_2", "acc_3"},
        // One more than floors, and a gap.
        {"acc_1", "acc_2", "acc_3", "acc_4", "acc_5"},
        {"acc_1", "acc_2", "acc_4", "acc_5"},
        // Channels.
        {"CH1", "CH2", "CH3", "CH4"},
        {"Kanal 1", "Kanal 2", "Kanal 3", "Kanal 4"},
        {"column_1", "column_2", "column_3", "column_4"},
        {"sensor1", "sensor2", "sensor3", "sensor4"},
        // Two numbers.
        {"a1 23", "a2 24", "a3 25", "a4 26"},
        {"north", "south"}}) {
    const PlacesByName found = FindPlacesByName(names, 4);
    for (const int place : found.places) EXPECT_EQ(place, kPlaceUnclear);
    EXPECT_THAT(found.doubt, HasSubstr(names[0]));
  }
}

TEST(SensorPlacesTest, FloorsThatAreNotThereAndPlacesTwice) {
  PlacesByName found = FindPlacesByName({"base", "Etage 1", "Etage 6"}, 5);
  EXPECT_THAT(found.places, ElementsAre(0, 1, kPlaceUnclear));
  EXPECT_THAT(found.doubt, HasSubstr("'Etage 6': the building has 5 storeys"));
  found = FindPlacesByName({"base", "Etage 1 X", "Etage 1 Y"}, 5);
  EXPECT_THAT(found.places, ElementsAre(0, kPlaceUnclear, kPlaceUnclear));
  EXPECT_THAT(found.doubt, HasSubstr("same place"));
  // Three at one place, and two bases.
  EXPECT_THAT(Places({"Dach", "roof", "toit"}, 2),
              ::testing::Each(kPlaceUnclear));
  EXPECT_THAT(Places({"base", "ground"}, 2), ::testing::Each(kPlaceUnclear));
  // A base that names a floor too.
  EXPECT_THAT(Places({"ground floor 1"}, 2), ElementsAre(kPlaceUnclear));
}

}  // namespace
}  // namespace pinode
