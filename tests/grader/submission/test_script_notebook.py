"""A notebook that was saved as Python is read as the same notebook, whichever program saved it."""

from __future__ import annotations

import pytest
from student_work import CLASS, IMPORTS, MAIN, NODE, OLD, PROGRAM, zipped

from grader.exercise import Exercise
from grader.submission.program_choice import digest_of
from grader.submission.reader import of_content

OTHER = PROGRAM.replace("heartbeat", "pulse").replace("Heartbeat", "Pulse")


def commented(text: str) -> str:
    """Return a text whose lines are all comments."""
    return "".join(f"# {line}".rstrip() + "\n" for line in text.splitlines())


def of_nbconvert(*cells: str) -> str:
    """Return cells as nbconvert writes them."""
    magics = (cell.partition("\n") for cell in cells)
    calls = (f"get_ipython().run_cell_magic('node', {first.split()[1]!r}, {body!r})" for first, _, body in magics)
    return "#!/usr/bin/env python\n# coding: utf-8\n\n# # Week 3\n\n" + "".join(
        f"# In[3]:\n\n\n{one}\n\n\n" for one in calls
    )


MAGIC = "# Commented out IPython magic to ensure Python compatibility.\n"
SAVED = {
    "nbconvert": of_nbconvert(NODE),
    "nbconvert with another node": of_nbconvert(f"%%node pulse\n{OTHER}", NODE),
    "nbconvert of ordinary cells": "# In[1]:\n\n\nget_ipython().system('pip install rclpy')\n"
    f"files = get_ipython().getoutput('ls')\n\n\n# In[ ]:\n\n\n{PROGRAM}",
    "jupytext, percent": "# %% [markdown]\n# # Week 3\n\n# %%\n# %load_ext spinbook\n\n# %%\n"
    f"# {NODE}\n# %%\n# %check heartbeat\n",
    "jupytext with another node": f"# %%\n# %%node pulse\n{OTHER}\n# %%\n# {NODE}",
    "jupytext, a whole cell": f"# %%\n{commented(NODE)}\n# %%\nx = 1\n",
    "jupytext, light": f"# # Week 3\n\n# +\n{commented(NODE)}# -\n\n# Text\n",
    "Colab": f'"""Untitled0.ipynb"""\n\n!pip install rclpy\n\n{MAGIC}{commented(NODE)}\n{MAGIC}# %check heartbeat\n',
    "Colab with another node": f"{MAGIC}{commented(f'%%node pulse{chr(10)}{OTHER}')}\n{MAGIC}{commented(NODE)}",
    "PyCharm": f"#%% md\n# Week 3\nIt *beats*.\n#%%\n%%node heartbeat\n{PROGRAM}#%%\n%check heartbeat\n",
    "cells below each other": f"%%node pulse\n{OTHER}\n{NODE}",
    "line ends of Windows": of_nbconvert(NODE).replace("\n", "\r\n"),
}


@pytest.mark.parametrize("text", SAVED.values(), ids=SAVED)
def test_a_notebook_that_was_saved_as_python_is_read_as_its_cells(text: str, exercise: Exercise) -> None:
    alone = of_content("week3.py", text.encode(), exercise)
    assert digest_of(alone.source) == digest_of(PROGRAM)
    assert "Your file is a notebook that was saved as Python." in alone.notes[0]
    packed = of_content("week3.zip", zipped({"week3.py": text, "README.md": "mine"}), exercise)
    assert digest_of(packed.source) == digest_of(PROGRAM)


def test_marimos_cells_are_functions(exercise: Exercise) -> None:
    body = "".join(f"    {line}".rstrip() + "\n" for line in f"{IMPORTS}\n{CLASS}\n{MAIN}".splitlines())
    text = f"import marimo\n\napp = marimo.App()\n\n\n@app.cell\ndef _():\n{body}    return (main,)\n\n\n"
    text += "@app.cell(hide_code=True)\ndef _(main):\n    main()\n    return\n\n\n"
    text += "if __name__ == '__main__':\n    app.run()\n"
    source = of_content("heartbeat.py", text.encode(), exercise).source
    assert CLASS in source
    assert source.endswith("main()\n")
    assert "marimo" not in source
    broken = of_content("heartbeat.py", text.replace("return (main,)", "return (").encode(), exercise)
    assert "a marimo notebook that can't be read" in broken.problem


def test_two_versions_in_it_are_a_question_as_in_the_notebook(exercise: Exercise) -> None:
    assert "2 cells of the notebook" in of_content("week3.py", of_nbconvert(NODE, OLD).encode(), exercise).question


def test_a_script_in_cells_is_a_script(exercise: Exercise) -> None:
    submission = of_content("heartbeat.py", f"# %%\nimport os\n# %%\n{PROGRAM}".encode(), exercise)
    assert submission.source.startswith("# %%\nimport os")
    assert submission.notes == ()
