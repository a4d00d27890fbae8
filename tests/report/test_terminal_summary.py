"""What a finished run prints: the table, what it shows, and the page."""

import csv

from industnerf.report.terminal_summary import conclusion, print_summary

ROW = {
    "method": "nerf",
    "inputs": "rgb",
    "split": "test",
    "emd_even": "0.03",
    "ratio_to_floor": "3",
    "failures": "0",
    "parts": "3",
    "undertrained": "",
    "paper_emd": "",
}
ROWS = [
    ROW | {"method": "oracle", "inputs": "own mesh (bound)", "ratio_to_floor": "1.01"},
    ROW | {"method": "industnerf_plus", "ratio_to_floor": "1.75"},
    ROW | {"method": "industnerf", "ratio_to_floor": "2.5", "paper_emd": "0.0122"},
    ROW | {"method": "r2n2", "inputs": "frame + rgb", "undertrained": "no better than retrieval"},
    ROW | {"method": "box", "split": "dev"},
]
COSTS = [
    {"stage": "reconstruct", "method": "industnerf", "cpu_seconds": "20"},
    {"stage": "reconstruct", "method": "industnerf", "cpu_seconds": "22"},
    {"stage": "evaluate", "method": "industnerf", "cpu_seconds": "99"},
]


def write_csv(path, rows):
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def test_the_table_says_inputs_undertrained_networks_and_the_paper(tmp_path, capsys):
    write_csv(tmp_path / "table1.csv", ROWS)
    write_csv(tmp_path / "cost.csv", COSTS)
    print_summary(tmp_path, tmp_path / "shown")
    output = capsys.readouterr().out
    lines = output.splitlines()
    (paper_line,) = [line for line in lines if line.split()[:1] == ["industnerf"]]
    assert paper_line.split() == ["industnerf", "rgb", "0.0300", "2.50", "21.0", "0.0122"]
    assert "own mesh (bound)" in output
    assert "(undertrained)" in lines[[line.startswith(" r2n2") for line in lines].index(True) + 1]
    assert " box" not in output
    assert output.count("report.html") == 1
    assert str(tmp_path / "shown/report.html") in output
    assert max(map(len, lines[:-2])) <= 80


def test_failures_have_a_column_where_there_are_any(tmp_path, capsys):
    write_csv(tmp_path / "cost.csv", COSTS)
    printed = []
    for failures in ("0", "2"):
        write_csv(tmp_path / "table1.csv", [ROW | {"failures": failures}])
        print_summary(tmp_path, tmp_path)
        printed.append("failed" in capsys.readouterr().out)
    assert printed == [False, True]


def test_one_sentence_names_the_best_method_and_the_papers():
    assert conclusion(ROWS[:4]) == (
        "On 3 parts industnerf_plus comes closest to the true surface: 1.75 times the EMD of a "
        "perfect reconstruction (x floor); industnerf, the paper's method, reaches 2.50 times."
    )
    assert conclusion(ROWS[2:3]).endswith(
        "2.50 times the EMD of a perfect reconstruction (x floor)."
    )
    assert conclusion(ROWS[:1]) == (
        "x floor: EMD over that of a perfect reconstruction, the mean of 3 parts."
    )
