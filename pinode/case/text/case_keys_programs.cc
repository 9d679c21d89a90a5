// Keys of the fit, of single programs and of pictures.

#include "pinode/case/text/case_keys.h"

namespace pinode {
namespace {

CaseTable ProfilesKeys() {
  return {"profiles",
          "[profiles]",
          "",
          {
              {"parameters", "texts", "names", "all named ones that are free",
               "Parameters whose profile likelihood `pinode_update` computes "
               "after the fit, as with `--profiles`. See \"Profiles\"."},
          }};
}

CaseTable DamageKeys() {
  return {"damage",
          "[damage]",
          "",
          {
              {"kinds", "texts", "`mass`, `damping`, `stiffness`, `nonlinear`",
               "all",
               "Kinds of change that are looked for beside the groups; `[]`: "
               "none. See \"Kinds of change\"."},
              {"masses", "texts", "DOFs, or nodes of DOFs `node.direction`",
               "those with a mass; above 40 DOFs those that a fitted channel "
               "measures",
               "Places to which mass may have been added."},
              {"place", "tables", "",
               "free stiffness groups that are one spring between two DOFs or "
               "a DOF and the ground",
               "Places where a nonlinear force may have appeared."},
          }};
}

CaseTable DamagePlaceKeys() {
  return {"damage.place",
          "[[damage.place]]",
          "",
          {
              {"name", "text", "", "needed", "Name of the place."},
              {"between", "texts", "two DOFs, or `ground` and a DOF", "needed",
               "Its ends."},
          }};
}

CaseTable ModesKeys() {
  return {
      "modes",
      "[modes]",
      "",
      {
          {"lowest_hz", "number", "Hz", "50 cycles in the record",
           "Modes are looked for from here."},
          {"highest_hz", "number", "Hz",
           "0.95 of half the sampling rate, 0.85 with a measured load",
           "Modes are looked for up to here."},
          {"references", "texts", "DOFs of channels, else names",
           "all; those that all records have",
           "Channels that correlations are taken with. They tie set-ups "
           "together."},
          {"max_order", "whole number", "even, from 2",
           "60, or what the channels allow", "Highest order of the models."},
          {"block_rows", "whole number", "from 2",
           "12 to 40, so that it has some 600 rows",
           "Block rows of the Hankel matrix."},
          {"max_damping_ratio", "number", "", "0.15",
           "Poles that are more damped are no modes. Those of a free decay are "
           "named."},
          {"harmonics", "true or false", "", "false",
           "true: harmonics of machines are in modes.toml too."},
          {"method",
           "\"automatic\" or \"covariance_driven\" or \"data_driven\" or "
           "\"input_output\" or \"ring_down\"",
           "", "\"automatic\"", "`automatic` chooses by what each record is."},
          {"pick", "numbers", "Hz", "those that orders agree on",
           "The modes nearest to these, and no others."},
          {"threads", "whole number", "from 1", "those of the machine",
           "Number of threads."},
          {"frf", "table", "", "none",
           "Estimate frequency response functions first, and find their modes: "
           "`frf = {}` or `[modes.frf]`."},
      }};
}

CaseTable ModesFrfKeys() {
  return {
      "modes.frf",
      "[modes.frf]",
      "",
      {
          {"estimator", "\"h1\" or \"h2\" or \"hv\"", "", "\"h1\"",
           "The noise is in the responses (`h1`), in the force (`h2`), or in "
           "both (`hv`)."},
          {"excitation",
           "\"automatic\" or \"blows\" or \"random\" or \"periodic\"", "",
           "\"automatic\"",
           "Blows of a hammer, a random force, or one that repeats itself. "
           "`automatic`: blows if the force is a few short pulses, else "
           "random."},
          {"block", "number", "s",
           "up to the next blow; some 16 blocks of a random force",
           "Length of the blocks that are averaged; of `periodic` the period, "
           "which it needs."},
          {"overlap", "number", "a share", "0.5",
           "Overlap of the blocks of a random force; refused for others."},
          {"force_window", "number", "s", "none",
           "After this time from the beginning of a block, the force of a blow "
           "is set to zero."},
          {"exponential_window", "number", "s", "none",
           "Time constant of an exponential window on blows and responses. "
           "The damping of the modes is corrected for it; `[[frf]]` refuses "
           "such functions."},
      }};
}

CaseTable ReferenceCurveKeys() {
  return {"reference_curve",
          "[[reference_curve]]",
          "",
          {
              {"term", "text", "", "needed",
               "Element, library or network of one output that the curve is "
               "drawn beside. An acceleration is shown as the force that "
               "resists, which needs a mass that is coupled to no other."},
              {"name", "text", "", "\"reference\"", "Name in the legend."},
              {"file", "text", "", "needed", "CSV file with a header line."},
              {"deformation", "text", "a column, model units",
               "\"deformation\"", "Column of the deformation."},
              {"force", "text", "a column, model units", "\"force\"",
               "Column of the force; it resists positive deformation."},
          }};
}

CaseTable OptionsKeys() {
  return {"options",
          "[options]",
          "",
          {
              {"shooting", "\"multiple\" or \"single\"", "",
               "multiple; single with unknown forces",
               "`multiple` goes by stages: see \"The way\" in "
               "pinode/theory/verdict.md. `single` fits whole records and all "
               "terms at once."},
              {"segment_samples", "whole number", "", "0",
               "Samples of a segment in the first stage; 0: chosen."},
              {"max_iterations", "whole number", "", "2000",
               "Levenberg-Marquardt iterations in all."},
              {"robust_loss", "\"none\" or \"huber\" or \"cauchy\"", "",
               "\"none\"", "Loss function of the residuals."},
              {"robust_scale", "number", "sigma", "3",
               "Scale of the loss function."},
              {"derivatives", "\"tangents\" or \"jets\"", "", "\"tangents\"",
               "How derivatives are computed."},
              {"covariance", "\"auto\" or \"plain\" or \"sandwich\"", "",
               "\"auto\"",
               "How intervals are computed. `plain` and `sandwich` take the "
               "excitation as exact."},
              {"threads", "whole number", "1 to 1024", "those of the machine",
               "Number of threads."},
              {"multistart", "whole number", "", "0",
               "Number of starts. 0: 8 for linear structures with twice as "
               "many stiffness groups as sensors, 16 for frequencies without "
               "shapes, else 1; up to 4 for linear structures whose first "
               "start ends no better than no motion. Starts are drawn between "
               "`lower` and `upper`, "
               "or two `prior_sigma`. Without these, stiffness goes from half "
               "to twice its nominal size, and damping from a third to three "
               "times. The best has the least training free-run error, without "
               "records the least cost."},
              {"seed", "whole number", "", "1", "Seed of all random numbers."},
              {"tolerance", "number", "", "1e-10",
               "Relative change of the cost that ends a stage."},
          }};
}

CaseTable GeometryKeys() {
  return {"geometry",
          "[geometry]",
          "",
          {
              {"file", "text", "", "this or `nodes`",
               "A deck of CalculiX or Abaqus, a universal file (.uff, .unv), "
               "or bulk data of Nastran (.bdf, .nas, .dat). See \"Pictures of "
               "the structure\"."},
              {"nodes", "table", "three coordinates per node", "this or `file`",
               "Nodes by name: `{g = [0, 0, 0], a = [0, 0, 3]}`."},
              {"line", "tables", "", "none",
               "Lines that join nodes, of a file too."},
              {"dofs", "table", "place or places per DOF", "none",
               "Where DOFs are that are not called `node.direction`, and which "
               "way (1, 2, 3: along x, y, z; `-`: against it): `{u1 = \"a.1\", "
               "u2 = [\"b.1\", \"-c.1\"]}`. Several places, as of a floor, "
               "move together."},
              {"groups", "table", "set or sets per group",
               "the set that is called like the group",
               "Element sets of groups: `{mass_1 = \"beams_1\"}`."},
          }};
}

CaseTable GeometryLineKeys() {
  return {
      "geometry.line",
      "[[geometry.line]]",
      "",
      {
          {"nodes", "texts", "two or more", "needed",
           "Nodes that the line goes through, from one to the next."},
          {"set", "text", "", "none", "Element set that the line belongs to."},
      }};
}

CaseTable PlanKeys() {
  return {
      "plan",
      "[plan]",
      "",
      {
          {"criterion", "\"determinant\" or \"worst_deviation\"", "",
           "\"determinant\"",
           "`determinant`: the smallest confidence region. `worst_deviation`: "
           "the least of the largest deviations."},
          {"parameters", "texts", "names", "free groups of stiffness and mass",
           "Parameters that are to be found."},
          {"keep_own", "true or false", "", "false",
           "true: the case's own sensors stay, and more are chosen."},
          {"durations", "numbers", "s", "none",
           "Says what the planned sensors reach with the records cut to "
           "these."},
          {"excite", "texts", "DOFs", "none",
           "DOFs at which the records' first force could act alone; each gets "
           "sensors of its own."},
          {"candidate", "tables", "", "accelerations, at all translations",
           "Sensors that there could be."},
      }};
}

CaseTable PlanCandidateKeys() {
  return {"plan.candidate",
          "[[plan.candidate]]",
          "",
          {
              {"dofs", "texts", "DOFs", "all translations",
               "Places. Of a reduced finite-element model any of its DOFs."},
              {"quantity", "text", "", "\"absolute_acceleration\"",
               "`absolute_acceleration`, `displacement`, `velocity` or "
               "`relative_acceleration`."},
              {"sigma", "number", "in `unit`",
               "as noisy as the others of its quantity",
               "Standard deviation of the noise; this or `sigma_percent`."},
              {"unit", "text", "", "needed with `sigma`", "Unit of `sigma`."},
              {"sigma_percent", "number", "%", "none",
               "Noise as a part of what each sensor would show."},
          }};
}

CaseTable SimulateKeys() {
  return {"simulate",
          "[simulate]",
          "",
          {
              {"noise_percent", "number",
               "% of the standard deviation of each channel", "0",
               "Noise that is added; this or `noise`."},
              {"noise", "\"sigma\"", "", "none",
               "Noise of each channel is its own `sigma`."},
              {"seed", "whole number", "", "1", "Seed of the noise."},
          }};
}

CaseTable DiscoverKeys() {
  return {"discover",
          "[discover]",
          "candidates",
          {
              {"source", "\"network\" or \"derivatives\"", "", "\"network\"",
               "What is regressed. `network`: the networks along the predicted "
               "states of the training records. `derivatives`: see \"Discovery "
               "without a network\"."},
              {"networks", "texts", "names", "all", "Networks to replace."},
              {"features", "texts", "features", "the network's inputs",
               "What candidates are made of."},
              {"solver", "\"lasso\" or \"stlsq\"", "", "\"lasso\"",
               "What proposes the sets of terms."},
              {"tolerance", "number",
               "of the RMS of the DOF's acceleration (force)", "0.005",
               "The fewest terms are taken that lose less than this, or less "
               "than the uncertainty of what is regressed, if that is more."},
              {"bags", "whole number", "", "0",
               "Size of an ensemble over time blocks, for inclusion "
               "probabilities; 0: none."},
              {"library_fraction", "number", "a fraction", "1",
               "Part of the candidates that each bag is offered."},
              {"seed", "whole number", "", "1", "Seed of the ensemble."},
              {"refit", "true or false", "", "true",
               "Fit the coefficients to the trajectories."},
              {"search", "true or false", "", "true",
               "Look among the candidates for what the regression has missed."},
              {"prune_fraction", "number", "of `tolerance`", "0.1",
               "After the refit, terms below this are dropped."},
              {"output", "tables", "", "none",
               "Outputs with a library or conditions of their own."},
          }};
}

CaseTable DiscoverOutputKeys() {
  return {"discover.output",
          "[[discover.output]]",
          "candidates",
          {
              {"name", "text", "", "needed",
               "Output, as in the network's outputs."},
              {"given", "table", "number per term", "none",
               "Known coefficients: in the equation as they are, and fixed in "
               "the refit. `{\"x[u1]\" = -3.0}`."},
              {"positive", "texts", "terms", "none",
               "Terms whose coefficient is not negative."},
              {"negative", "texts", "terms", "none",
               "Terms whose coefficient is not positive."},
          }};
}

CaseTable CandidatesKeys() {
  return {
      "candidates",
      "candidates",
      "",
      {
          {"constant", "true or false", "", "false, or as `[discover]` has it",
           "The candidate 1."},
          {"polynomial_degree", "whole number", "",
           "3, or as `[discover]` has it",
           "Monomials of degree 1 up to this one; 0: none."},
          {"products", "true or false", "", "true, or as `[discover]` has it",
           "Also products of several features."},
          {"polynomial_features", "texts", "features", "all",
           "Features that monomials are made of."},
          {"sine", "texts", "features", "none",
           "Features whose sine is a candidate."},
          {"cosine", "texts", "features", "none",
           "Features whose cosine is one."},
          {"absolute", "texts", "features", "none",
           "Features whose absolute value is one: `abs(v[u1])`."},
          {"sign", "texts", "features", "none",
           "Features whose sign is one: `sign(v[u1])`."},
          {"signed_square", "texts", "features", "none",
           "Features whose signed square is one: `abs(x[u1])*x[u1]`."},
          {"expressions", "texts", "functions", "none",
           "Further library functions: `[\"x[u1]^5\"]`."},
      }};
}

}  // namespace

std::vector<CaseTable> ProgramCaseTables() {
  return {ProfilesKeys(), DamageKeys(),         DamagePlaceKeys(),
          ModesKeys(),    ModesFrfKeys(),       ReferenceCurveKeys(),
          OptionsKeys(),  GeometryKeys(),       GeometryLineKeys(),
          PlanKeys(),     PlanCandidateKeys(),  SimulateKeys(),
          DiscoverKeys(), DiscoverOutputKeys(), CandidatesKeys()};
}

}  // namespace pinode
