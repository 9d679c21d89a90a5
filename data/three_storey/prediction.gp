# The figure of the project's README: the held-out record of this case, as
# measured, as the prior model predicts it and as the updated model does.
#
#   pinode_update   --case=data/three_storey/three_storey.toml --output_dir=R
#   pinode_simulate --case=data/three_storey/three_storey.toml --output_dir=S
#   gnuplot -c data/three_storey/prediction.gp \
#     R/prediction_holdout.csv S/response_holdout.csv \
#     data/three_storey/prediction.svg
#
# Needs gnuplot 5.4. The errors in the titles are computed here, over the whole
# record.

if (ARGC != 3) {
  print "usage: gnuplot -c prediction.gp PREDICTION.csv RESPONSE.csv FIGURE.svg"
  exit status 2
}
updated = ARG1
prior = ARG2
# Both files have one line a sample: `both` is their lines side by side, t and
# a3 of the prior model in columns 8 and 11.
both = sprintf("< paste -d, '%s' '%s'", updated, prior)

set datafile separator ","
stats updated using "a3_measured" name "measured" nooutput
spread = measured_stddev * sqrt(measured_records)
stats both every ::1 using ($6 - $7) name "updated" nooutput
stats both every ::1 using ($6 - $11) name "prior" nooutput
nrmse(sum_of_squares) = 100.0 * sqrt(sum_of_squares) / spread

set terminal svg size 820,430 font "sans-serif,13" background "white"
set output ARG3
set multiplot layout 2,1 margins 0.085,0.985,0.125,0.91 spacing 0,0.13
set xrange [10:16]
set yrange [-13:13]
set ytics -10,5,10
set grid ytics lc rgb "#dddddd" lt 1
set border 3
set tics nomirror scale 0.5
set key at graph 1,1.1 right center horizontal samplen 2 width 1 Left reverse
set ylabel "m/s^2" offset 1

set label 1 sprintf("Prior model: error %.0f %%", nrmse(prior_sumsq)) \
  at graph 0.005,1.1 left
set format x ""
plot both every ::1 using 1:6 with lines lw 3 lc rgb "#b0b0b0" \
       title "measured, top floor", \
     both every ::1 using 1:11 with lines lw 1.4 lc rgb "#c03a2b" \
       title "prior model"

set label 1 sprintf("Updated model: error %.1f %%", nrmse(updated_sumsq))
set format x "%g"
set xlabel "time (s)" offset 0,0.5
plot both every ::1 using 1:6 with lines lw 3 lc rgb "#b0b0b0" \
       title "measured, top floor", \
     both every ::1 using 1:7 with lines lw 1.4 lc rgb "#1f5f99" \
       title "updated model"
unset multiplot
