"""What stands below the tables and figures of the page."""

TABLE1 = (
    "Lower is better. EMD is the exact Wasserstein-1 distance in units of the true bounding-box "
    "diagonal, on what the reference rig sees, and beside it the mean in mm; <i>full</i> is of the "
    "whole surface. <i>floor</i> is the same metric between two independent samples of the truth: "
    "what a perfect method scores, but for chance. <i>even</i> compares geometry alone, <i>iid</i> "
    "geometry and density. The interval is a bootstrap over families. A failed part scores the "
    "worse of its ball and its box. A row marked null knows no picture of the part, a row marked "
    "bound is given the answer. A net is undertrained if its validation loss was still falling, or "
    "if retrieval or the mean shape is as good. The paper's numbers have no published protocol."
)
TABLE2 = (
    "The held-out views, rendered by the method and photographed. RGB (linear, white is 1), PSNR "
    "and SSIM are over the pixels that show the part in truth or in the rendering (opacity of at "
    "least one half), and beside that over the whole frame. The error of depth (squared, "
    "bounding-box diagonal 1) is over the pixels where both have a depth; <i>coverage</i> is the "
    "share of the true foreground that has one. Over the whole frame, pixels that both leave empty "
    "count as right. <i>best</i> is the floor of the EMD, and of the others what nothing beats. "
    "Failed parts count in the EMD alone. <i>Confidence</i> is of all candidates within 5 % of the "
    "diagonal of the visible surface, against their distance to the true surface as densely "
    "sampled: rank correlation (-1 is best), and the area between the sparsification curves by "
    "confidence and by the true error, which is 0 for the true order. The paper does not say what "
    "its errors average over."
)
BY_PART = (
    "EMD (even) of every method, and in mm. <i>visible</i> is the share of the surface that can be "
    "seen from anywhere around the part, <i>seen</i> the share that its training views show; the "
    "strata are formulas on the mesh (docs/reference/dataset.md). A part's name links to its scores."
)
PARETO = (
    "EMD (even) against seconds a part. No method is at once quicker and better than one on the "
    "red line; nulls and bounds are hollow, and not on it. cost.csv beside this page has all "
    "parts."
)
DISTRIBUTION = (
    "EMD (even) divided by the part's floor, a dot for each part, reported and dev alike; the red "
    "stroke is the median, red dots are failures, which score as a null. A dot leads to its part."
)
CALIBRATION = (
    "A dot for each part. Above: rank correlation between confidence and the distance to the true "
    "surface, -1 is best and 0 is chance. Below: the area between the sparsification curves (AUSE) "
    "as a multiple of what a random order gives, 0 is best and 1 is chance."
)
CURVES = (
    "The curves themselves, each the mean over the reported parts. The candidates near the surface "
    "are removed, the least sure first: if confidence says what is wrong, the error of those left "
    "falls. The area between a method's curve and its dashed one is the AUSE."
)
RENDERINGS = (
    "Photographs that no method was shown, and beside each what the method renders from there."
)
SHEET = (
    "A row a part and a column a method, colored by the distance to the true surface; of several "
    "answers of a net it is the first that has points. contact_sheet.png beside this page is "
    "larger."
)
