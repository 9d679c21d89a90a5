// Keys of records and measured modes.

#include "pinode/case/text/case_keys.h"

namespace pinode {
namespace {

// Keys that several tables of a record have.
CaseKey FileKey() {
  return {"file", "text", "", "the record's file", "File that has the column."};
}

CaseKey UnitKey() {
  return {
      "unit", "text", "see \"Units\"", "what the file states for the column",
      "Unit of the column, checked against the quantity. An AT2 file is in g."};
}

CaseKey RemoveOffsetKey() {
  return {"remove_offset", "true or false", "", "false",
          "Subtract the mean of the whole file before anything else."};
}

CaseTable RecordKeys() {
  return {
      "record",
      "[[record]]",
      "",
      {
          {"name", "text", "", "needed", "Name of the record."},
          {"role", "\"train\" or \"holdout\"", "", "\"train\"",
           "A hold-out takes no part in the fit and is predicted."},
          {"file", "text", "", "that of its columns",
           "Text of a data logger or CSV, .at2, .uff, .unv, .mat, .npy, .npz, "
           ".h5, .tdms, .lvm, .mseed, .sac or .v2: see \"Files of records\"."},
          {"time", "text", "a column", "this or `sampling_rate_hz`",
           "Column of the time."},
          {"sampling_rate_hz", "number", "Hz", "this or `time`",
           "Rate of a file without a column of the time."},
          {"time_unit", "text", "`s`, `ms`, `us`, `ns`, `min`, `h` or `day`",
           "what the file states, else `s`", "Unit of the column of the time."},
          {"time_format", "text", "as strptime has it", "found",
           "Form of clock times, such as `%d/%m/%Y %H:%M:%S`. See \"Text "
           "files\" for this and the next four."},
          {"header_lines", "whole number", "", "found",
           "Lines above the first row of numbers."},
          {"delimiter", "text", "", "found",
           "`,` `;` `tab` `blank`, or a bar."},
          {"decimal", "\".\" or \",\"", "", "found", "Decimal sign."},
          {"encoding", "text", "", "found",
           "Any name that iconv knows, such as `ISO-8859-1`."},
          {"duration", "number", "s, fewer than 1e8 samples",
           "that of the file",
           "Of `pinode_simulate` for a record without a file, with "
           "`sampling_rate_hz`."},
          {"window", "numbers", "s, from and to", "all",
           "Part of the record that is used."},
          {"resample_hz", "number", "Hz", "the record's own rate",
           "Rate of the samples that are fitted, at most a hundred times the "
           "record's own."},
          {"interpolation",
           "\"held\" or \"linear\" or \"cubic\" or \"band_limited\"", "",
           "needed with an excitation",
           "What the excitation does between its samples."},
          {"periodic", "true or false", "", "false",
           "The record is whole periods of a steady state. The excitation goes "
           "on with its first sample after the last. A hold-out starts from "
           "the model's own steady state, from no sample of it."},
          {"start", "\"rest\" or \"free\" or table", "", "\"free\"",
           "State at the first sample. `\"free\"` is estimated; a table has a "
           "known state, or `from`."},
          {"start_samples", "whole number", "from 1",
           "of a hold-out 5 % of the record",
           "A free start is found from this many samples alone. Of a hold-out "
           "they are not scored. In a training record the start is then no "
           "unknown of the fit, and is found on the model before the fit."},
          {"substeps", "whole number", "", "0",
           "Runge-Kutta steps per sample; 0: none or chosen. See \"Steps\"."},
          {"integrator", "\"auto\" or \"rk4\" or \"exact\" or \"exponential\"",
           "", "\"auto\"", "`exact` is for linear models. See \"Steps\"."},
          {"ground", "tables", "", "none", "Ground acceleration."},
          {"force", "tables", "", "none", "Measured forces at DOFs."},
          {"motion", "tables", "", "none",
           "Motion of DOFs that an actuator prescribes. See \"Prescribed "
           "motion\"."},
          {"covariate", "tables", "", "none", "Temperature and the like."},
          {"channel", "tables", "", "needed",
           "Measured responses. `pinode_check --plan` needs none."},
          {"filter", "table", "", "none",
           "Filter of the measured channels and their predictions."},
          {"excitation", "\"measured\" or \"ambient\" or \"none\"", "",
           "\"measured\"",
           "`ambient`: loads that were not measured act, with or without "
           "measured ones. Such a record has no motion and no start, and no "
           "offset or delay; a gain must be known, `{initial = ...}`. See "
           "\"Ambient records\". `none`: the structure is left to itself from "
           "the first sample (of the window) "
           "on."},
          {"ambient", "table", "", "see its keys",
           "Loads of a record with `excitation = \"ambient\"`."},
      }};
}

CaseTable StartKeys() {
  return {"record.start",
          "`start` of `[[record]]`",
          "",
          {
              {"x", "numbers", "one per DOF, model units", "zero",
               "Known displacements at the first sample."},
              {"v", "numbers", "one per DOF, model units", "zero",
               "Known velocities at the first sample."},
              {"from", "\"first\"", "", "none",
               "With `samples`, in place of `x` and `v`: the same as "
               "`start_samples`."},
              {"samples", "whole number", "from 1", "needed with `from`",
               "How many of the first samples."},
          }};
}

CaseTable AmbientKeys() {
  return {
      "record.ambient",
      "[record.ambient]",
      "",
      {
          {"dofs", "texts", "DOFs",
           "on each mode in the band and up to twice its end",
           "DOFs at which the loads act. Give this, `areas`, "
           "`proportional_to_mass` or none of them."},
          {"areas", "table", "by name: DOFs, or `{dof = share}`", "none",
           "Loads that each act on several DOFs together, alike or by these "
           "shares: `{deck = [\"u1\", \"u2\"], tower = {u3 = 1.0, u4 = "
           "0.5}}`."},
          {"proportional_to_mass", "texts", "directions", "none",
           "Forces like those of an acceleration in these directions."},
          {"base", "texts", "directions", "none",
           "Accelerations of the base, beside loads or alone. Absolute "
           "accelerations see them themselves."},
          {"correlated", "true or false", "", "true",
           "Whether loads at different places may have something in common."},
          {"knots", "whole number", "", "0",
           "Knots of the loads' spectrum. 1: white. 0: one an octave of the "
           "band, more where the record asks for it."},
          {"band_hz", "numbers", "Hz, from and to",
           "from 0.3 of the model's lowest frequency to 1.5 of its highest, at "
           "most 0.8 of half the sampling rate",
           "Band of the record that is looked at."},
      }};
}

CaseTable GroundKeys() {
  return {"record.ground",
          "[[record.ground]]",
          "",
          {
              {"direction", "text", "", "needed",
               "Direction of the ground motion, such as `x`."},
              {"column", "text", "", "needed; not of an AT2 file",
               "Column of the acceleration."},
              UnitKey(),
              FileKey(),
              {"scale", "number", "", "1", "The column is multiplied by it."},
              RemoveOffsetKey(),
              {"sigma", "number", "in `unit`", "0",
               "Standard deviation of the column's noise; this or "
               "`sigma_percent`."},
              {"sigma_percent", "number",
               "% of the standard deviation of the column", "0",
               "Noise of the column."},
          }};
}

CaseTable ForceKeys() {
  return {
      "record.force",
      "[[record.force]]",
      "",
      {
          {"dof", "text", "a DOF", "needed", "DOF at which the force acts."},
          {"column", "text", "", "needed", "Column of the force."},
          UnitKey(),
          FileKey(),
          {"scale", "number or unknown", "", "1",
           "The column is multiplied by it. An unknown is free unless it says "
           "otherwise, and is called `scale.force_<dof>`. See \"Unknown "
           "sensors\"."},
          RemoveOffsetKey(),
          {"sigma", "number", "in `unit`", "0",
           "Standard deviation of the column's noise; this or "
           "`sigma_percent`."},
          {"sigma_percent", "number",
           "% of the standard deviation of the column", "0",
           "Noise of the column."},
      }};
}

CaseTable ForceScaleKeys() {
  return {"record.force.scale",
          "`scale` of `[[record.force]]`",
          "unknown",
          {
              {"name", "text", "", "`force_<dof>`",
               "The unknown is called `scale.<name>`, and all forces of that "
               "name share it."},
          }};
}

CaseTable MotionKeys() {
  return {
      "record.motion",
      "[[record.motion]]",
      "",
      {
          {"dof", "text", "a DOF", "needed", "DOF whose motion is prescribed."},
          {"quantity", "\"displacement\" or \"velocity\" or \"acceleration\"",
           "", "\"displacement\"",
           "One table each, as they are measured. The displacement is needed."},
          {"column", "text", "", "needed", "Column of the motion."},
          UnitKey(),
          FileKey(),
          {"scale", "number", "", "1", "The column is multiplied by it."},
          RemoveOffsetKey(),
      }};
}

CaseTable CovariateKeys() {
  return {"record.covariate",
          "[[record.covariate]]",
          "",
          {
              {"name", "text", "", "needed", "Name of the covariate."},
              {"column", "text", "", "needed without `value`",
               "Column of the covariate: no unit, no conversion. Cells may be "
               "empty, with straight lines across them."},
              FileKey(),
              {"value", "number", "", "none",
               "The same value all the time, in place of a column."},
          }};
}

CaseTable ChannelKeys() {
  return {
      "record.channel",
      "[[record.channel]]",
      "",
      {
          {"name", "text", "", "the column", "Name of the sensor."},
          {"column", "text", "",
           "needed; not for `pinode_simulate` and `--plan`",
           "Column of the response."},
          FileKey(),
          {"quantity", "text", "", "needed",
           "`displacement`, `velocity`, `relative_acceleration`, "
           "`absolute_acceleration`, `absolute_displacement`, `strain`, or "
           "`force` of an actuator (see \"Prescribed motion\")."},
          {"dof", "text", "a DOF", "this or `combination`",
           "Place of the sensor."},
          {"combination", "table", "weight per DOF", "this or `dof`",
           "Sum that the sensor measures: `{u1 = -1.0, u2 = 1.0}`."},
          {"gauge_length", "number", "length", "needed of a strain",
           "Length between the ends of the gauge. See \"Strain gauges\"."},
          {"distance", "number", "length", "none",
           "Distance from the neutral axis, where the combination is one of "
           "rotations."},
          UnitKey(),
          {"sign", "number", "1 or -1", "1", "-1: the sensor is upside down."},
          {"scale", "number", "", "1",
           "The column is multiplied by it; the product is in `unit`."},
          {"sigma", "number", "in `unit`", "estimated",
           "Standard deviation of the sensor's noise; this or "
           "`sigma_percent`."},
          {"sigma_percent", "number",
           "% of the standard deviation of the channel", "estimated",
           "Noise of the sensor."},
          RemoveOffsetKey(),
          {"gain", "unknown", "", "1",
           "Gain of the sensor. If it is free, its sign is found. See "
           "\"Unknown sensors\"."},
          {"offset", "unknown", "in `unit`", "0",
           "Constant that the sensor adds."},
          {"delay", "unknown", "s", "0", "Time by which the sensor is late."},
          {"fit", "true or false", "", "true",
           "false: the channel is predicted and scored only."},
      }};
}

CaseTable OffsetKeys() {
  return {"record.channel.offset",
          "`offset` of `[[record.channel]]`",
          "unknown",
          {
              {"shared", "true or false", "", "false",
               "true: one offset for all records of the sensor."},
          }};
}

CaseTable FilterKeys() {
  return {
      "record.filter",
      "[record.filter]",
      "",
      {
          {"type", "\"lowpass\" or \"highpass\" or \"bandpass\"", "", "needed",
           "Zero-phase Butterworth filter of this type, on every measured "
           "channel and on its prediction."},
          {"corner_hz", "number or numbers", "Hz", "needed",
           "Corner; of `bandpass` two."},
          {"order", "whole number", "from 1", "4",
           "Order of the one-way filter."},
      }};
}

CaseTable ModalKeys() {
  return {"modal",
          "[modal]",
          "",
          {
              {"form",
               "\"eigenvector_difference\" or \"mac\" or \"dynamic_residual\"",
               "", "\"eigenvector_difference\"",
               "Form of the residuals: see \"Measured modes\". `mac` gives no "
               "intervals."},
              {"covariates", "table", "number per covariate",
               "groups that follow one are as at the reference",
               "Covariates of the structure while the modes were measured: "
               "`{temperature = 12.5}`."},
          }};
}

CaseTable ModeKeys() {
  return {
      "mode",
      "[[mode]]",
      "",
      {
          {"name", "text", "", "its number", "Name of the mode."},
          {"frequency", "number", "Hz", "needed", "Measured frequency."},
          {"frequency_sigma", "number", "Hz", "none",
           "Standard deviation of the frequency; this or `frequency_weight`."},
          {"frequency_weight", "number", "", "1",
           "Weight of 1 - f_model^2 / f^2."},
          {"shape", "table or text", "number per DOF, or a file",
           "not measured",
           "Mode shape at these DOFs, at any scale and sign: `{u1 = 0.41, u3 = "
           "1.0}`. A file has a column per DOF and a row per mode, empty where "
           "not measured."},
          {"shape_row", "whole number", "from 1", "1", "Row of the file."},
          {"shape_sigma", "number or table", "the shape's unit", "none",
           "Standard deviation of every entry, or of each: `{u1 = 0.02, u3 = "
           "0.05}` (`eigenvector_difference`); this, `shape_weight` or "
           "`shape_covariance`."},
          {"shape_weight", "number", "", "1",
           "Weight of the shape's residuals, the largest entry being 1."},
          {"shape_covariance", "matrix", "", "none",
           "Covariance of the entries, a row and a column each in their order, "
           "as `modes.toml` has it."},
          {"frequency_shape_covariance", "numbers",
           "Hz times the shape's unit, one per entry", "none",
           "Covariance of the frequency with each entry. It needs "
           "`shape_covariance` and `frequency_sigma`."},
          {"residual_weight", "number", "1 / force", "1",
           "Weight of `dynamic_residual`, in place of all of these."},
      }};
}

CaseTable FrfKeys() {
  return {
      "frf",
      "[[frf]]",
      "",
      {
          {"name", "text", "", "`frf` and its number", "Name of the set-up."},
          {"files", "texts", "", "needed",
           "Files with the functions, in the formats of `pinode_modes`."},
          {"responses", "texts", "places", "as the files have them",
           "Places of the responses, one for all functions or one for each. A "
           "minus sign in front turns the direction."},
          {"references", "texts", "places", "as the files have them",
           "Places of the forces, in the same way."},
          {"dofs", "table", "DOF by place", "places are names of DOFs",
           "DOFs of the places: `{p1 = \"u1\", p2 = \"-u3\"}`."},
          {"quantity", "\"acceleration\" or \"velocity\" or \"displacement\"",
           "", "as the files state", "Measured motion per force."},
          {"unit", "text", "", "the model's unit",
           "Unit of the motion, such as `m/s^2` or `g`."},
          {"force_unit", "text", "", "the model's unit",
           "Unit of the force, such as `N`."},
          {"band_hz", "numbers", "Hz, from and to", "all lines above 0 Hz",
           "Band of the lines that are fitted."},
          {"stride", "whole number", "from 1", "1",
           "The fit uses every n-th line of the band."},
          {"noise", "\"constant\" or \"relative\" or \"coherence\"", "",
           "`coherence` if all files have it, else `constant`",
           "Noise of the lines of one function: equal, in proportion to the "
           "function, or as the coherence says. Its level is estimated."},
          {"sigma", "number", "unit of the functions", "estimated",
           "Standard deviation of the real and of the imaginary part; its root "
           "mean square over the lines if the noise is `relative` or "
           "`coherence`."},
          {"gain", "unknown", "", "1", "Gain of each response."},
          {"delay", "unknown", "s", "0",
           "Time by which each response is late."},
          {"loss_factor", "unknown", "", "0",
           "Hysteretic damping: the stiffness in these functions is "
           "`(1 + i loss_factor) K`. All `[[frf]]` share the unknown."},
      }};
}

}  // namespace

std::vector<CaseTable> RecordCaseTables() {
  return {RecordKeys(),  StartKeys(),      AmbientKeys(), GroundKeys(),
          ForceKeys(),   ForceScaleKeys(), MotionKeys(),  CovariateKeys(),
          ChannelKeys(), OffsetKeys(),     FilterKeys(),  ModalKeys(),
          ModeKeys(),    FrfKeys()};
}

}  // namespace pinode
