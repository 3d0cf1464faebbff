// Compiles in a page's archives what every page imports before its first program. Node.js runs this when a site is made.
import { pathToFileURL } from "node:url";

const [pyodide, folder] = process.argv.slice(2);
const { loadPyodide } = await import(pathToFileURL(`${pyodide}/pyodide.mjs`));
const py = await loadPyodide({ indexURL: `${pyodide}/` });
py.mountNodeFS("/archives", folder);
py.FS.symlink("/archives/ros.zip", "/ros.zip");
py.runPython(`
import sys; sys.path.insert(0, "/ros.zip")
from spinbook.browser.in_page import compiling, process
process.prepare()
compiling.compile_imported("/archives")
`);
process.exit(0);
