"""Sentences of the lab, by the code of the problem."""

from __future__ import annotations

from kirigami_studio.foundation.words import mark

SENTENCES: dict[str, str | tuple[str, str]] = {
    # training
    "training.unknown_family": mark("There is no family of designs called '{family:.40}'. Choose one of {choices}."),
    "training.no_samples_wanted": mark("A data set needs at least 1 sample, got {count_wanted}."),
    "training.fields_ended": mark("The data set could not be filled: no more fields to try."),
    "training.mask_differs": mark(
        "The data set is wrong: a stored mask agrees with its design to IoU {iou:.4f} only. Generate it again."
    ),
    "training.split_unreadable": mark("Cannot read a data set from {path}. Make it with 'kirigami-studio dataset'."),
    "training.split_altered": mark(
        "The data set {path} is not what its content hash names. Make it again with 'kirigami-studio dataset'."
    ),
    "training.shape_without_area": mark("The shape has no area."),
    "training.fits_unreadable": mark("Cannot read training data from {path}. Make it with 'kirigami-studio dataset'."),
    "training.fits_differ": mark(
        "The training data in {path} was made with other settings ({settings}). Choose another folder."
    ),
    "training.fits_of_other_grid": mark(
        "Training on {rows} x {columns} voids needs fits of that grid, but these are of {fit_rows} x {fit_columns}."
    ),
    "training.no_fits": mark("There are no designs to train on. Make some with 'kirigami-studio dataset'."),
    "training.unknown_coupling": mark("There is no coupling called '{coupling:.40}'. Choose one of {choices}."),
    "training.unknown_advantages": mark("There are no advantages called '{advantages:.40}'. Choose one of {choices}."),
    "training.group_too_small": mark("A group needs at least 2 designs to compare, got {group}."),
    "training.rollout_too_small": mark(
        "Targets of a step and sampling steps must be 1 or more, got {batch} and {rollout_steps}."
    ),
    "training.rates_not_positive": mark(
        "Temperature and learning rate must be above 0, got {temperature:g} and {learning_rate:g}."
    ),
    "training.decay_out_of_range": mark("The decay of averaged weights must be from 0 to below 1, got {decay:g}."),
    "training.negative_bounds": mark(
        "Weight clip, reference and least spread must be 0 or more, got {weight_clip:g}, {reference:g} and "
        "{least_spread:g}."
    ),
    "training.too_few_calls": mark("These settings need at least {needed} environment calls, got {calls}."),
    "training.kept_after_end": mark(
        "Weights cannot be kept after {kept} environment calls in a run of {calls}. Choose fewer."
    ),
    "training.kept_too_late": mark(
        "The run in {folder} has made {calls} environment calls, its weights after {kept} are gone. "
        "Choose more calls, or another folder."
    ),
    "training.unknown_reward": mark("There is no reward called '{reward:.40}'. Choose one of {choices}."),
    "training.other_start": mark(
        "These are not the weights or fits that the settings name. Start with those, or in another folder."
    ),
    "training.other_network": mark(
        "The weights to start from belong to a network of another shape. Start from others."
    ),
    "training.diverged": mark(
        "Training diverged: the loss is no longer a number. Start again with a lower learning rate."
    ),
    "training.checkpoint_unreadable": mark("Cannot read the checkpoint {path}. Delete it to start afresh."),
    "training.checkpoint_differs": mark(
        "The checkpoint {path} was made with other settings ({settings}). Choose another folder."
    ),
    "training.folder_not_made": mark("Cannot make the run folder {folder}: {reason}. Choose another folder."),
    "training.no_threads": mark("Training needs at least 1 thread, got {threads}."),
    "training.no_cuda": mark("No CUDA device is available. Use --device cpu, or install a GPU build of torch."),
    "training.too_few_gpus": mark(
        "Process {number} of this machine has no GPU of its own: there are {gpus}. Start fewer, or use --device cpu."
    ),
    "training.batch_not_shared": mark(
        "A batch of {batch} cannot be split evenly over {processes} processes. Choose a multiple of {processes}."
    ),
    "training.one_process_only": mark(
        "This training runs in one process, and torchrun started {processes}. Start it without torchrun."
    ),
    "training.unknown_device": mark("There is no device called '{device:.40}'. Use auto, cpu or cuda."),
    "training.fits_are_not_split": mark("Fits of drawn shapes are for training only. Leave out --split."),
    "training.grids_are_chosen": mark("First designs have grids of their own. Leave out --grid."),
    "training.channels_without_unet": mark(
        "--channels, --latent and --residuals belong to --backbone unet. Leave them out, or choose that backbone."
    ),
    "training.feedback_with_unet": mark(
        "--feedback belongs to the perceptron: the U-Net sees only the target's mask. Leave it out."
    ),
    "training.nothing_to_distil": mark(
        "Only first designs can be distilled. Give a file of them with --designs, or leave out {options}."
    ),
    "training.channels_not_whole": mark(
        "--channels must be whole numbers separated by commas, such as 64,128,256,384, got '{channels:.40}'."
    ),
    "training.fit_share_out_of_range": mark("--fit-share must be between 0 and 1, got {share:g}."),
    "training.share_above_one": mark("{option} is a share from 0 to 1, got {share:g}."),
    "training.cannot_record": mark(
        "--recorded needs one process with a GPU, and the network is on {device:.20}. Leave it out."
    ),
    "training.fits_not_recorded": mark("--recorded does not go with --fits. Leave one of them out."),
    "training.designs_of_other_grid": mark(
        "The network draws {rows} x {columns} ratios, and the data set has tables of {shape}. Make one for this grid."
    ),
    "training.too_few_designs": mark("A step takes {batch} designs, and there are only {designs}. Lower --batch."),
    "training.minutes_not_positive": mark("--minutes must be above 0, got {minutes:g}."),
    # benchmark
    "benchmark.no_targets_found": mark(
        "No targets found to measure on. Name a file, a folder with shapes, or 'library'."
    ),
    "benchmark.nothing_to_report": mark(
        "{path} has no figures to report. Run 'kirigami-studio benchmark solvers', 'generators' or 'grpo' with --out "
        "there."
    ),
    "benchmark.report_unreadable": mark(
        "Cannot make a report of {path}: a file there is not what this version's suites write. Run them again."
    ),
    "benchmark.generators_alike": mark("Two of these generators have one name: {names}. Compare them in two calls."),
    "benchmark.no_weights_kept": mark(
        "{path} has no weights from before and after calls. Run 'kirigami-studio train grpo' there with "
        "--keep-at 0 10000."
    ),
    "benchmark.grpo_runs_alike": mark(
        "Two of these runs have the same start and name: {names}. Compare them in two calls."
    ),
    "benchmark.no_targets": mark("This suite needs at least one target, got none."),
    "benchmark.unknown_method": mark("There is no method called '{method:.40}'. Choose among {choices}."),
    "benchmark.runs_differ": mark(
        "The runs in {path} were made with other settings or another version. Choose another folder."
    ),
    "benchmark.runs_unreadable": mark("Cannot read the runs in {path}. Delete the file, or choose another folder."),
    "benchmark.cma_missing": mark(
        "CMA-ES needs the package cma. Install it with pip install 'kirigami-studio[benchmark]', or leave CMA-ES out."
    ),
    "benchmark.too_few_to_time": mark(
        "Timings need at least one variant and two targets, got {variants} and {targets}."
    ),
    "benchmark.spread_of_one": mark("A spread needs at least 2 samples of each target, got {k}."),
    # problem
    "problem.unknown_split": mark("There is no split called '{split:.40}'. Choose one of {choices}."),
    "problem.unknown_baseline": mark(
        "There is no baseline called '{name:.80}'. Choose one of {choices}, or name a .safetensors file."
    ),
    "problem.not_a_leaderboard": mark("This .json file is not a leaderboard: it has no list of rows."),
    "problem.fields_missing": mark(
        "The generator gave {got} ratio fields for {wanted} targets. It has to give one for each, or None."
    ),
    "problem.other_grid": mark("Fields of {rows} x {columns} ratios are asked for, got an array of shape {shape}."),
    "problem.ratio_outside": mark(
        "The ratio in row {row}, column {column} is {ratio:.6g}. Ratios of this problem lie from {least:g} to {most:g}."
    ),
    "problem.no_such_callable": mark(
        "There is no generator '{source:.80}': {reason}. Name it MODULE:CALLABLE, in the folder of this call."
    ),
    "problem.generator_failed": mark("The generator '{source:.80}' failed with {kind}: {reason}"),
    # generators to compare with
    "model.baseline_pixels": mark(
        "Fields cannot be drawn into {latent} x {latent} pixels with masks of {mask}. They must be even at "
        "every level of the network but the last, and divide the mask."
    ),
    "model.diffusion_steps": mark("A diffusion model samples in 1 to {most} steps, got {steps}."),
    "model.unknown_baseline": mark("There is no generator called '{kind:.40}'. Choose one of {choices}."),
    "model.baseline_unreadable": mark(
        "Cannot read a generator from {path}. Train one with 'kirigami-studio train cvae', 'cgan' or 'diffusion'."
    ),
}
