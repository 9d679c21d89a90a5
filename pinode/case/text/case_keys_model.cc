// Keys of the model and its unknowns.

#include "pinode/case/text/case_keys.h"

namespace pinode {
namespace {

CaseTable RootKeys() {
  return {"",
          "a case",
          "",
          {
              {"title", "text", "", "none", "Title, printed in the report."},
              {"units", "table", "", "N, m, s", "Units of the model."},
              {"model", "table", "", "needed",
               "Matrices, shear building or finite-element model, reduction, "
               "damping."},
              {"group", "tables", "", "none",
               "Corrections of stiffness, damping and mass."},
              {"element", "tables", "", "none", "Force laws between DOFs."},
              {"library", "tables", "", "none",
               "Sums of functions with unknown coefficients."},
              {"unknown_force", "tables", "", "none",
               "Forces that were not measured."},
              {"network", "tables", "", "none", "Neural networks."},
              {"record", "tables", "", "needed without measured modes",
               "Records: files, ground, forces, motion, covariates, channels, "
               "filter, ambient loads."},
              {"frf", "tables", "", "none",
               "Measured frequency response functions. Such a case may do "
               "without records."},
              {"modal", "table", "", "see its keys",
               "How measured modes are used."},
              {"mode", "tables", "", "none",
               "Measured modes. Such a case may do without records."},
              {"reference_curve", "tables", "", "none",
               "Known force curves, drawn in the report."},
              {"options", "table", "", "see its keys", "The fit."},
              {"profiles", "table", "", "no profiles",
               "Profile likelihoods after the fit of `pinode_update`."},
              {"damage", "table", "", "see its keys",
               "What `pinode_damage` looks for."},
              {"modes", "table", "", "see its keys",
               "How `pinode_modes` looks for modes."},
              {"plan", "table", "", "see its keys",
               "Places of sensors for `pinode_check --plan`."},
              {"simulate", "table", "", "see its keys",
               "Noise of `pinode_simulate`."},
              {"discover", "table", "", "see its keys",
               "Candidates and search of `pinode_discover`."},
              {"geometry", "table", "", "no pictures",
               "Places of nodes, for pictures."},
          }};
}

CaseTable UnitsKeys() {
  return {"units",
          "[units]",
          "",
          {
              {"force", "text", "a unit of force", "\"N\"",
               "`N`, `kN`, `MN`, `kgf`, `lbf` or `kip`. The unit of mass "
               "follows from "
               "force, length and time."},
              {"length", "text", "a unit of length", "\"m\"",
               "`m`, `cm`, `mm`, `um`, `in` or `ft`."},
              {"time", "text", "a unit of time", "\"s\"", "`s`, `ms` or `us`."},
          }};
}

CaseTable ModelKeys() {
  return {
      "model",
      "[model]",
      "",
      {
          {"dofs", "texts", "one per DOF",
           "needed with matrices; of a shear building `u1`, `u2`, ...",
           "Names of the DOFs: no brackets, commas or blanks, no name twice, "
           "not `ground`."},
          {"mass", "matrix", "", "needed with matrices", "Mass matrix."},
          {"stiffness", "matrix", "", "needed with matrices",
           "Stiffness matrix."},
          {"damping", "matrix or \"none\" or table", "", "needed with records",
           "Damping: a matrix, or a rule (see `[model.damping]`). `\"none\"` "
           "is the same as no key in a case without records, whose modes need "
           "no damping."},
          {"influence", "table", "per direction one number per DOF",
           "`x`: all ones", "Vector r of each direction of ground motion."},
          {"support_mass_coupling", "table", "per direction one number per DOF",
           "zero",
           "Coupling M_fs of the masses with the supports, per direction."},
          {"expected_hz", "numbers", "Hz", "none",
           "`pinode_check` compares the model's frequencies with these."},
          {"shear_building", "table", "", "none",
           "A shear building in place of matrices."},
          {"finite_element", "table", "", "none",
           "A finite-element model in place of matrices: see \"Finite-element "
           "models\"."},
          {"reduction", "table", "", "none; needed above 100 DOFs",
           "Reduction of a finite-element model."},
      }};
}

CaseTable MatrixKeys() {
  return {"matrix",
          "matrix",
          "",
          {
              {"file", "text", "", "needed with `variable`",
               "File that holds several matrices. A file with one matrix needs "
               "no table: write its name (.csv, .mtx, .matrix, .mat, .npz, "
               ".op4), or rows `[[...], ...]`."},
              {"variable", "text", "", "the only matrix of the file",
               "Name of the matrix in the file."},
              {"diagonal", "numbers", "one per row", "none",
               "Diagonal of a diagonal matrix, in place of a file."},
          }};
}

CaseTable DampingKeys() {
  return {"model.damping",
          "[model.damping]",
          "matrix",
          {
              {"rayleigh", "numbers", "two", "none",
               "a0 and a1 of C = a0 M + a1 K."},
              {"ratios", "numbers", "one per mode", "none",
               "Damping ratio of each mode; the last one is repeated for the "
               "modes above. 0.02 is 2 %; above 1 is refused."},
          }};
}

CaseTable ShearBuildingKeys() {
  return {"model.shear_building",
          "[model.shear_building]",
          "",
          {
              {"masses", "numbers", "one per floor", "needed",
               "Masses of the floors, from the ground up."},
              {"stiffnesses", "numbers", "one per storey", "needed",
               "Stiffnesses of the storeys, from the ground up."},
              {"dampers", "numbers", "one per storey", "none: `model.damping`",
               "Dampers of the storeys."},
          }};
}

CaseTable FiniteElementKeys() {
  return {
      "model.finite_element",
      "[model.finite_element]",
      "",
      {
          {"mass", "text or matrix file", "", "needed",
           "Mass matrix as exported. Formats: see pinode/README.md."},
          {"stiffness", "text or matrix file", "", "needed",
           "Stiffness matrix as exported."},
          {"damping", "text or matrix file", "",
           "none: `model.damping`, of the reduced model",
           "Damping matrix as exported."},
          {"dofs", "text or texts or matrix file",
           "a file with one name a line, or the names", "those of the export",
           "Names of the DOFs, such as `1.1`, where the format has none."},
          {"remove_dofs", "texts", "DOFs", "none",
           "DOFs that stand still: supports."},
          {"ground_directions", "table", "direction numbers 1 to 3",
           "x, y, z = 1, 2, 3 where DOFs have them",
           "Ground motion by direction number: `{x = 1, y = 2}`."},
          {"expected_frequencies", "numbers", "Hz, lowest above 0 Hz", "none",
           "Frequencies of the finite-element program. The case is refused if "
           "the model's differ by more than `frequency_tolerance`."},
          {"frequency_tolerance", "number", "a fraction", "0.01",
           "Largest relative difference from `expected_frequencies`."},
      }};
}

CaseTable MatrixFileKeys() {
  return {
      "matrix file",
      "matrix file",
      "",
      {
          {"file", "text", "", "needed", "The file."},
          {"variable", "text", "", "the only matrix of the file",
           "Name of the matrix in the file."},
          {"occurrence", "whole number", "from 1", "the only one of the name",
           "Which of several matrices of one name, as OP4 files of "
           "superelements have them."},
      }};
}

CaseTable ReductionKeys() {
  return {
      "model.reduction",
      "[model.reduction]",
      "",
      {
          {"method", "\"guyan\" or \"serep\" or \"craig_bampton\" or \"modal\"",
           "", "needed", "Method of reduction."},
          {"keep", "texts", "DOFs",
           "all that the rest of the case names, else those of the modes' "
           "shapes",
           "DOFs that stay."},
          {"modes", "whole number", "", "0",
           "Modes of `craig_bampton` beside the DOFs that stay; of `modal` in "
           "all, with coordinates q1, q2, ... A model without supports keeps "
           "its rigid-body modes. The DOFs that stay must hold them (`guyan`, "
           "`craig_bampton`), or they count among the modes."},
          {"compare", "whole number", "", "6",
           "Number of modes that are compared with those of the whole model."},
          {"renew", "true or false", "", "false",
           "Take the basis again where the groups are found to be."},
          {"basis_at", "table", "number per group", "the export",
           "Take the basis where groups of K and M have these values: "
           "`{columns = -0.1}`."},
          {"expand", "texts or \"all\"", "DOFs", "none",
           "DOFs whose responses are written; `\"all\"` of at most 5000."},
      }};
}

CaseTable UnknownKeys() {
  return {
      "unknown",
      "unknown",
      "",
      {
          {"initial", "number", "",
           "0 of groups and terms, 1 of gains and scales", "Initial value."},
          {"lower", "number", "", "none", "Lower bound."},
          {"upper", "number", "", "none", "Upper bound."},
          {"prior_mean", "number", "", "`initial`", "Mean of the prior."},
          {"prior_sigma", "number", "", "no prior",
           "Standard deviation of the prior."},
          {"free", "true or false", "",
           "true; of `gain`, `offset` and `delay` false",
           "Whether the fit may change the value."},
          {"tie", "text", "", "none",
           "Name of another unknown that this one follows. It then has none of "
           "the keys above."},
          {"tie_factor", "number", "", "1",
           "Multiple of the other unknown, both in the model's units."},
      }};
}

CaseTable GroupKeys() {
  return {
      "group",
      "[[group]]",
      "unknown",
      {
          {"name", "text", "", "needed",
           "Name of the unknown alpha. Names become parts of file names: "
           "letters, digits, `_`, `-`, `.`, `+`."},
          {"adds_to", "\"stiffness\" or \"damping\" or \"mass\"", "", "needed",
           "Matrix that the correction alpha K_j (C_j, M_j) is added to."},
          {"between", "texts", "two DOFs, or `ground` and a DOF", "none",
           "A unit spring (damper) between two DOFs, times `scale`. Give this "
           "or one of the next seven keys."},
          {"matrix", "matrix", "", "none", "Any symmetric matrix."},
          {"storey", "whole number", "from 1", "none",
           "Storey of a shear building, with its own stiffness or damper."},
          {"proportional_to", "\"mass\" or \"stiffness\"", "", "none",
           "Of damping: this matrix of the model times `scale`, a part of "
           "Rayleigh's C."},
          {"mode", "whole number", "from 1", "none",
           "Of damping: that of one mode of the model with the damping ratio "
           "`ratio`, as in `damping = {ratios = [...]}`. alpha = 0.5 adds half "
           "of it. The modes are those of the initial model; in a reduction "
           "with `renew` they follow the fit."},
          {"modes_from", "whole number", "from 1", "none",
           "Of damping: the same for this mode and all higher ones."},
          {"ratio", "number", "", "needed with `mode` and `modes_from`",
           "Damping ratio of these modes: 0.02 is 2 % of critical."},
          {"changed_export", "text or matrix file", "", "none",
           "Of a finite-element model: the export with the property of an "
           "element set times `factor`."},
          {"set_export", "text or matrix file", "", "none",
           "Of a finite-element model: the export of the element set alone."},
          {"factor", "number", "", "needed with `changed_export`",
           "Factor of the property in `changed_export`. Then alpha = -0.1 "
           "means: the set has lost a tenth of the property."},
          {"scale", "number", "", "1",
           "With `between`: alpha = 1 adds this much stiffness. Also with "
           "`proportional_to`."},
          {"present", "number", "", "1",
           "How many times `matrix` the model's matrices hold of the group "
           "already. `pinode_damage` reports changes as fractions of `present` "
           "+ alpha."},
          {"follows", "table", "", "nothing",
           "Time or covariate that the correction follows."},
      }};
}

CaseTable FollowsKeys() {
  return {"group.follows",
          "`follows` of `[[group]]`",
          "",
          {
              {"covariate", "text", "", "this or `time`",
               "Name of the covariate. Without `knots` alpha multiplies "
               "(covariate - `reference`)."},
              {"time", "\"linear\"", "", "this or `covariate`",
               "Alpha multiplies (t - `reference`)."},
              {"reference", "number", "seconds, or the covariate's unit",
               "0; needed with `knots`",
               "Where the correction is zero; of a table the knot at which the "
               "group has its own value."},
              {"knots", "numbers", "two or more, ascending", "no table",
               "Values of the covariate: makes a table, see \"Tables of a "
               "covariate\"."},
              {"smoothness", "\"evidence\" or number", "", "by the evidence",
               "How much alpha may change from one knot to the next: a "
               "standard deviation, for knots at the mean distance. A wider "
               "gap allows more (as its root)."},
              {"differences", "whole number", "1 or 2", "1",
               "1: neighbouring values are alike, so that alpha stays as it is "
               "where there are no data. 2: neighbouring slopes are alike, and "
               "it continues in a straight line; needs three knots."},
              {"values", "numbers", "one per knot, 0 at the reference", "zero",
               "Changes to begin with."},
              {"free", "true or false", "", "true",
               "Whether the changes are unknown. The group's own `free`, "
               "bounds and priors are those of its value at the reference."},
          }};
}

CaseTable ElementKeys() {
  return {"element",
          "[[element]]",
          "",
          {
              {"name", "text", "", "needed",
               "Name. The unknowns are called `<name>.<parameter>`."},
              {"type", "text", "", "needed", "Law: see \"Element types\"."},
              {"file", "text", "", "none",
               "Shared library that has the type, if it is your own."},
              {"between", "texts", "two DOFs, or `ground` and a DOF", "needed",
               "Ends. The deformation is the second minus the first; the force "
               "acts on both."},
              {"parameters", "table", "", "the law's own",
               "Parameters of the law, each by its name."},
              {"optional", "true or false", "", "false",
               "true: the element is left out if the records do not support "
               "it. See \"Choice of the model\"."},
          }};
}

CaseTable ElementParametersKeys() {
  return {
      "element.parameters",
      "`parameters` of `[[element]]`",
      "",
      {
          {"*", "number or unknown", "model units", "the law's default, fixed",
           "A number is a fixed parameter. `{initial = ...}` is an unknown, "
           "within the physical range of the law."},
      }};
}

CaseTable LibraryKeys() {
  return {
      "library",
      "[[library]]",
      "",
      {
          {"name", "text", "", "needed",
           "Name. The unknowns are called `<name>.<term>`, such as "
           "`nl1.x[u1]^3`."},
          {"inputs", "texts", "features", "needed",
           "What the terms may look at, as for networks."},
          {"output", "text", "a DOF, or a pair `u1-u2`", "needed",
           "Where the sum acts."},
          {"acts_as", "\"acceleration\" or \"force\"", "", "\"acceleration\"",
           "An acceleration is added to dv/dt; a force is subtracted from the "
           "right-hand side."},
          {"terms", "array", "functions, or tables", "needed",
           "Terms: see \"Library functions\". A function alone begins at 0 and "
           "is free."},
          {"select", "true or false", "", "false",
           "true: free terms that the records do not support are left out. See "
           "\"Choice of the model\"."},
      }};
}

CaseTable LibraryTermKeys() {
  return {"library.terms",
          "table in `terms` of `[[library]]`",
          "unknown",
          {
              {"basis", "text", "", "needed", "The function."},
          }};
}

CaseTable UnknownForceKeys() {
  return {
      "unknown_force",
      "[[unknown_force]]",
      "",
      {
          {"name", "text", "", "needed", "Name of the force."},
          {"dof", "text", "a DOF", "needed",
           "DOF at which the force acts, positive along it."},
          {"record", "text", "", "needed with several records",
           "Record in which it acts."},
          {"shape", "\"cubic\" or \"linear\" or \"half_sine\"", "", "\"cubic\"",
           "`cubic` and `linear` are splines in time. `half_sine` is amplitude "
           "sin(pi (t - start) / duration); it takes `parameters` in place of "
           "the keys of splines."},
          {"window", "numbers", "s, from and to", "needed, of splines",
           "Knots from here to there; the force is zero outside."},
          {"knot_spacing", "number", "s", "needed, of splines",
           "Distance of the knots."},
          {"scale", "number", "force", "needed, of splines",
           "About the size of the force: the unit of the search."},
          {"neighbourhood", "whole number", "from 1", "1",
           "Number of knots that share one smoothness. See \"Unknown "
           "forces\"."},
          {"relaxation", "number", "s", "none: it goes on in a straight line",
           "Time in which a force falls to zero where the data do not ask for "
           "it."},
          {"band_hz", "numbers", "Hz, from and to", "none",
           "Frequencies between which the force lives, in place of "
           "`neighbourhood` and `relaxation`."},
          {"values", "numbers", "force, one per knot", "zero",
           "Coefficients to begin with."},
          {"free", "true or false", "", "true",
           "Whether the fit may change the force."},
          {"parameters", "table", "", "needed, of `half_sine`",
           "Parameters of the pulse."},
          {"truth", "text", "a column", "none",
           "Column of the record's file, in the model's unit, that the report "
           "draws beside the force. It has no other use."},
      }};
}

CaseTable PulseParametersKeys() {
  const char* number_or_unknown = "number or unknown";
  return {"unknown_force.parameters",
          "`parameters` of `[[unknown_force]]`",
          "",
          {
              {"start", number_or_unknown, "s", "needed",
               "Begin of the pulse. If it is free, it is looked for within its "
               "bounds."},
              {"duration", number_or_unknown, "s", "needed",
               "Duration of the pulse."},
              {"amplitude", number_or_unknown, "force", "needed",
               "Largest value of the pulse."},
          }};
}

CaseTable NetworkKeys() {
  return {
      "network",
      "[[network]]",
      "",
      {
          {"name", "text", "", "needed", "Name of the network."},
          {"inputs", "texts", "features", "needed",
           "`x[dof]`, `v[dof]`, `d[a,b]`, `w[a,b]` (relative displacement b - "
           "a, velocity), `t`, `input[name]`. name: a covariate, "
           "`ground_<direction>` or `force_<dof>`; a, b may be `ground`."},
          {"input_scale", "numbers", "one per input",
           "about their size in the training records",
           "Inputs are divided by these before the first layer."},
          {"outputs", "texts", "DOFs, or pairs `u1-u2`", "needed",
           "Where the network acts. A pair: g on u1 and -g on u2."},
          {"output_scale", "numbers", "one per output",
           "about the acceleration of the training records; of a force times "
           "the mass it acts on",
           "The last layer is multiplied by these."},
          {"acts_as", "\"acceleration\" or \"force\"", "", "\"acceleration\"",
           "An acceleration is added to dv/dt; a force is subtracted from the "
           "right-hand side. With `memory` it is always \"force\"."},
          {"layers", "whole numbers", "from 1", "`[20]`; with `memory` `[6]`",
           "Widths of the hidden layers; `[]` is a linear map."},
          {"activation", "text", "", "\"tanh\"",
           "`tanh`, `sigmoid`, `relu`, `leaky_relu`, `softplus`, `sine` or "
           "`identity`."},
          {"bias", "true or false", "", "true, or as `weights` has it",
           "Whether layers have a bias."},
          {"skip", "true or false", "", "true, or as `weights` has it",
           "Linear path from inputs to outputs."},
          {"gauge", "\"auto\" or \"on\" or \"off\"", "", "\"auto\"",
           "`auto` removes value and slope at rest where a free group or "
           "element spans the inputs. See \"The gauge\"."},
          {"decay", "\"evidence\" or \"none\" or number", "",
           "by the evidence; with `memory` 0.1", "Weight decay."},
          {"memory", "whole number", "1 to 4", "none",
           "Sliders with a state of their own, for a device with hysteresis. "
           "It gives no energy beyond what its springs held at the start. See "
           "\"Networks with memory\"."},
          {"values", "numbers", "one per weight", "seeded",
           "Weights of a network with memory, as `model.toml` has them. They "
           "need both scales."},
          {"seed", "whole number", "", "that of `[options]`",
           "Seed of the initial weights."},
          {"weights", "text", "a file",
           "seeded; the last layer is zero where there is a skip path, "
           "stiffness, damping or a term",
           "Start from saved weights, such as `network_nn1.json`. What else "
           "the file says of the network may be left out here."},
          {"free", "true or false", "", "true",
           "Whether the fit may change the weights."},
          {"truth", "text", "a column", "none",
           "Of a network of t alone that acts as a force: as for "
           "`[[unknown_force]]`."},
      }};
}

}  // namespace

std::vector<CaseTable> ModelCaseTables() {
  return {RootKeys(),          UnitsKeys(),
          ModelKeys(),         MatrixKeys(),
          DampingKeys(),       ShearBuildingKeys(),
          FiniteElementKeys(), MatrixFileKeys(),
          ReductionKeys(),     UnknownKeys(),
          GroupKeys(),         FollowsKeys(),
          ElementKeys(),       ElementParametersKeys(),
          LibraryKeys(),       LibraryTermKeys(),
          UnknownForceKeys(),  PulseParametersKeys(),
          NetworkKeys()};
}

}  // namespace pinode
