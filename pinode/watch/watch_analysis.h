// From the records of a structure to its histories, chart and alarms.

#ifndef PINODE_WATCH_WATCH_ANALYSIS_H_
#define PINODE_WATCH_WATCH_ANALYSIS_H_

#include <string>
#include <vector>

#include "pinode/watch/control_chart.h"
#include "pinode/watch/mode_histories.h"
#include "pinode/watch/normal_model.h"
#include "pinode/watch/sensor_history.h"
#include "pinode/watch/store.h"
#include "pinode/watch/structure_file.h"

namespace pinode {

// State of the structure in one word.
enum class WatchLight { kLearning, kNormal, kNotice, kAlarm };
// Returns "learning", "normal", "notice" or "alarm".
const char* WatchLightName(WatchLight light);

struct WatchAnalysis {
  // Records with modes, by time. Of records that begin at the same time, the
  // longest.
  std::vector<StoredRecord> records;
  int num_refused = 0;  // records without modes, by a refusal
  // Refused records whose time is known, by time.
  std::vector<StoredRecord> refused;
  int num_rejected = 0;            // records that a person has rejected
  int num_repeated = 0;            // records that a longer one replaces
  std::vector<bool> is_reference;  // of each record
  bool reference_is_complete = false;
  // Sensors that the shapes show to have changed. Their faults are set in the
  // records from then on.
  std::vector<SensorChange> sensor_changes;
  int num_histories = 0;  // with those that are not watched
  FeatureSeries series;
  // Mean frequency of each feature in the reference, Hz.
  Vector reference_hz;

  // False: there is no chart yet, and `reason` says why.
  bool has_chart = false;
  std::string reason;
  NormalModel model;
  // Frequency that the model expects, and its standard deviation, both as the
  // series' values; records x features.
  Matrix expected, expected_deviations;
  std::vector<ChartValues> chart;
  ChartThresholds thresholds;
  // Light after each record, and after the last record or refused one.
  std::vector<WatchLight> lights;
  WatchLight light = WatchLight::kLearning;
  std::vector<StoredEvent> events;
  // Decisions of people, which the analysis has allowed for.
  std::vector<StoredMend> mends;
};

// Analyses the records, in any order. The result does not depend on the order.
WatchAnalysis AnalyseRecords(const WatchedStructure& structure,
                             std::vector<StoredRecord> records);

// Does the part behind the histories: `series` with the reference becomes
// model, chart and events.
void AnalyseSeries(const WatchedStructure& structure, WatchAnalysis* analysis);

}  // namespace pinode

#endif  // PINODE_WATCH_WATCH_ANALYSIS_H_
