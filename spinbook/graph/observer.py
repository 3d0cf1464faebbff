"""Watches the node graph on behalf of another process: `python -m spinbook.graph.observer`.

Reads words from standard input, a line each, and ends with it:

    domain N    look at this ROS domain from now on
    count       listen to topics that have a listener anyway, to know their rates, until the next word
    look        stop that, wait until the graph is known, and print it as one line of JSON
"""

from __future__ import annotations

import json
import os
import queue
import sys
import threading

from spinbook.graph.sight import GraphWatcher
from spinbook.ros2.cli import CommandError


def _listen(words: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        words.put(line.strip())
    words.put("end")


def observe(words: queue.SimpleQueue[str]) -> None:
    """Do what the words say, until "end"."""
    word = words.get()
    while word != "end":
        os.environ["ROS_DOMAIN_ID"] = word.removeprefix("domain ")
        with GraphWatcher() as watcher:
            word = _look_at(watcher, words)


def _look_at(watcher: GraphWatcher, words: queue.SimpleQueue[str]) -> str:
    """Do what is asked of one domain; the word that ends it."""
    while (word := words.get()) != "end" and not word.startswith("domain "):
        while word == "count" and words.empty():
            watcher.count()
        watcher.stop_counting()
        if word == "look":
            watcher.wait_until_idle()
            print(json.dumps(json.loads(watcher.graph().to_json())), flush=True)
    return word


def main() -> None:
    """Observe until standard input ends."""
    words: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=(words,), daemon=True).start()
    try:
        observe(words)
    except CommandError as error:
        sys.exit(error.format_message())


if __name__ == "__main__":
    main()
