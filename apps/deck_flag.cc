#include "apps/deck_flag.h"

#include <gflags/gflags.h>

#include "apps/print.h"
#include "pinode/case/results/updated_deck.h"

DEFINE_string(deck, "",
              "input deck of CalculiX or Abaqus from which the case's matrices "
              "were exported; also write <name>_updated.inp, with the "
              "identified properties of the groups' element sets");

namespace pinode {

bool CheckDeckFlag(const Case& c, std::string* error) {
  return FLAGS_deck.empty() || CheckDeck(c, FLAGS_deck, error);
}

bool WriteDeck(const Case& c, const IdentifiedModel& model,
               const ResultFolder& folder, IdentificationSummary* summary,
               std::string* error) {
  if (FLAGS_deck.empty()) return true;
  std::string remark;
  const bool good = WriteUpdatedDeck(c, *summary, model, FLAGS_deck,
                                     folder.working_path(), &remark, error);
  if (!good) remark = "No updated deck: " + *error;
  if (!remark.empty()) summary->remarks.push_back(remark);
  return good;
}

void PrintNoDeck(const std::string& error) {
  PrintError("no updated deck: %s", error.c_str());
}

}  // namespace pinode
