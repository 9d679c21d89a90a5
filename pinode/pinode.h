// Header that includes what a program needs. With it a program
// - identifies a case file, or a problem from memory, and simulates;
// - finds modes, equations and damage, and plans sensors;
// - writes results and reports;
// - defines force laws of its own.
//
// Two things have headers of their own. Residual blocks for a ceres::Problem
// are in pinode/estimate/trajectory_cost.h and segment_cost.h. Ranks of an MPI
// job are in pinode/mpi/mpi_communicator.h.
//
// Sources that a comment cites by author and year are listed in
// pinode/theory/references.md.

#ifndef PINODE_PINODE_H_
#define PINODE_PINODE_H_

// IWYU pragma: begin_exports
#include "pinode/base/communicator.h"
#include "pinode/base/constants.h"
#include "pinode/base/parameter_block.h"
#include "pinode/base/types.h"
#include "pinode/base/units.h"
#include "pinode/case/results/result_files.h"
#include "pinode/case/sections/case_file.h"
#include "pinode/damage/change.h"
#include "pinode/damage/verdict.h"
#include "pinode/discover/discovery.h"
#include "pinode/discover/equation_options.h"
#include "pinode/dynamics/autodiff_law.h"
#include "pinode/dynamics/element_library.h"
#include "pinode/dynamics/feature.h"
#include "pinode/dynamics/force_scale_term.h"
#include "pinode/dynamics/group_curve.h"
#include "pinode/dynamics/group_term.h"
#include "pinode/dynamics/law.h"
#include "pinode/dynamics/law_term.h"
#include "pinode/dynamics/linear_dynamics.h"
#include "pinode/dynamics/network_term.h"
#include "pinode/dynamics/observation.h"
#include "pinode/dynamics/own_element.h"
#include "pinode/dynamics/structural_dynamics.h"
#include "pinode/dynamics/term.h"
#include "pinode/dynamics/unknown_force.h"
#include "pinode/dynamics/wide_jet.h"
#include "pinode/estimate/certainty/assessment.h"
#include "pinode/integrate/integrator.h"
#include "pinode/modal/identify_modes.h"
#include "pinode/modal/merge_setups.h"
#include "pinode/modal/response_record.h"
#include "pinode/modal/stabilisation_options.h"
#include "pinode/network/network.h"
#include "pinode/network/network_architecture.h"
#include "pinode/problem/ambient_record.h"
#include "pinode/problem/fit_summary.h"
#include "pinode/problem/identification_options.h"
#include "pinode/problem/identification_problem.h"
#include "pinode/problem/identification_summary.h"
#include "pinode/problem/identified_model.h"
#include "pinode/problem/measured_mode.h"
#include "pinode/problem/model_choice.h"
#include "pinode/problem/parameter_layout.h"
#include "pinode/problem/parameter_profile.h"
#include "pinode/problem/problem_description.h"
#include "pinode/problem/robust_loss.h"
#include "pinode/problem/tuning.h"
#include "pinode/problem/verdict.h"
#include "pinode/record/excitation.h"
#include "pinode/record/filter.h"
#include "pinode/report/gnuplot_options.h"
#include "pinode/report/html_report.h"
#include "pinode/report/report.h"
#include "pinode/structure/decks/finite_element_files.h"
#include "pinode/structure/matrices/matrix_market.h"
#include "pinode/structure/model/geometry.h"
#include "pinode/structure/model/mode_comparison.h"
#include "pinode/structure/model/structural_model.h"
#include "pinode/structure/sparse/finite_element_model.h"
#include "pinode/structure/sparse/reduction.h"
#include "pinode/structure/sparse/sparse_modes.h"
#include "pinode/study/damage/baseline.h"
#include "pinode/study/damage/damage_analysis.h"
#include "pinode/study/damage/damage_search.h"
#include "pinode/study/identify/identify.h"
#include "pinode/study/laws/refit.h"
#include "pinode/study/picture/structure_picture.h"
#include "pinode/study/problem/growth.h"
#include "pinode/study/problem/identification_watch.h"
#include "pinode/study/problem/make_problem.h"
#include "pinode/study/problem/simulation.h"
#include "pinode/study/problem/substeps.h"
#include "pinode/study/sensors/sensor_information.h"
#include "pinode/study/sensors/sensor_plan.h"
#include "pinode/study/terms/model_candidate.h"
// IWYU pragma: end_exports

#endif  // PINODE_PINODE_H_
