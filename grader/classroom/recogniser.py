"""Finds out which format a class's export has. A format is used only if nearly everything fits."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from grader.classroom.formats.format import Export, Format, Parts, UploadedFile
from grader.classroom.formats.registry import FORMATS, PLAIN, PLATFORMS
from grader.classroom.submissions import File, SubmissionsError
from grader.submission.file_kinds import kind_of

#: The kinds of files that can be submissions.
GRADABLE = ("python", "notebook", "archive", "launch file")

#: A folder with one of these is one student's package, not a class.
PACKAGE = {"package.xml", "setup.py", "setup.cfg", "CMakeLists.txt"}


def can_be_graded(name: str) -> bool:
    """Return whether a submission can have this name."""
    return kind_of(name) in GRADABLE


@dataclass(frozen=True)
class Recognition:
    """A class's files as one format understands them, below the folder `inside`.

    `misfits` are files that the format does not understand, each with the top-level name that it is below; `others`
    are files next to `inside`.
    """

    form: Format
    inside: Parts
    understood: tuple[tuple[File, UploadedFile | str], ...]
    misfits: tuple[tuple[str, File], ...]
    others: tuple[File, ...]

    @property
    def fits(self) -> set[tuple[str, ...]]:
        """The students whose submissions are understood."""
        return {tuple(s.id for s in place.students) for _, place in self.understood if isinstance(place, UploadedFile)}

    @property
    def odd(self) -> set[str]:
        """The top-level names with something to grade that do not fit."""
        return {top for top, file in self.misfits if can_be_graded(file.name)}

    @property
    def nearly_all(self) -> bool:
        """Whether this is the format: a tenth of the names may be odd, or one in a small class."""
        return len(self.fits) > len(self.odd) <= max(1, len(self.fits) // 10)


@dataclass(frozen=True)
class Recogniser:
    """Recognises the format of a class's files, which are those of an export in some format."""

    export: Export

    def recognise(self, name: str = "") -> Recognition:
        """Return the files as understood by the format `name`, or by the one that fits nearly all of them.

        Raises `SubmissionsError` if a format fits many of them but not nearly all, or if no file fits `name`.
        """
        if name == PLAIN.name:
            return self._plain()
        tried = [one for form in PLATFORMS if name in ("", form.name) for one in self._tried(form)]
        tried.sort(key=lambda one: (len(one.odd), -len(one.fits)))
        if name and not any(one.fits for one in tried):
            raise SubmissionsError(f"--format {name}: no file here has a name as in {FORMATS[name].title}.")
        if name:
            return max(tried, key=lambda one: len(one.fits))
        for one in tried:
            if one.nearly_all:
                return one
            if len(one.fits) > 1 and len(one.fits) >= len(one.odd):
                raise SubmissionsError(_unclear(one))
        return self._plain()

    def _tried(self, form: Format) -> Iterator[Recognition]:
        for inside in self._levels(form):
            understood = self._read(form, inside)
            if understood:
                yield understood

    def _plain(self) -> Recognition:
        understood = self._read(PLAIN, self._class_folder())
        assert understood
        return understood

    def _read(self, form: Format, inside: Parts) -> Recognition | None:
        skip = len(inside)
        below = {parts[skip:]: file for parts, file in self.export.files.items() if parts[:skip] == inside}
        root = inside[-1] if inside else self.export.root
        understand = form.read(replace(self.export, files=below, root=root))
        if not understand:
            return None
        places = [(parts, file, understand(parts)) for parts, file in below.items()]
        misfits = [(parts[0], file) for parts, file, place in places if place is None]
        outside = [(parts, file) for parts, file in self.export.files.items() if parts[:skip] != inside]
        tops = [(parts[:skip][-1], file) for parts, file in outside]
        misfits += [(top, file) for top, file in tops if top not in form.next_to]
        others = tuple(file for top, file in tops if top in form.next_to)
        understood = tuple((file, place) for _, file, place in places if place is not None)
        return Recognition(form, inside, understood, tuple(misfits), others)

    def _levels(self, form: Format) -> Iterator[Parts]:
        """Yield the folders that may contain the class: a lone folder around everything, and those that `form` has."""
        for inside in self._lone_folders():
            yield inside
            for name in sorted(self._entries(inside) & set(form.inside)):
                yield (*inside, name)

    def _lone_folders(self) -> Iterator[Parts]:
        """Yield the folders around everything, but for tables and notes next to them."""
        inside: Parts = ()
        while True:
            yield inside
            entries = {
                top for top in self._entries(inside) if (*inside, top) not in self.export.files or can_be_graded(top)
            }
            if len(entries) != 1 or (*inside, *entries) in self.export.files:
                return
            inside = (*inside, *entries)

    def _entries(self, inside: Parts) -> set[str]:
        return {parts[len(inside)] for parts in self.export.files if parts[: len(inside)] == inside}

    def _class_folder(self) -> Parts:
        """Return the lone folder around a whole class; a lone folder around one student's work does not count."""
        deepest = list(self._lone_folders())[-1]
        skip = len(deepest)
        with_work = {parts[skip] for parts in self.export.files if len(parts) > skip and can_be_graded(parts[-1])}
        is_package = any(parts[-1] in PACKAGE for parts in self.export.files)
        return deepest if len(with_work) > 1 and not is_package else ()


def _unclear(one: Recognition) -> str:
    others = "".join(f"\n  {name}" for name in sorted(one.odd))
    return (
        f"{len(one.fits)} submissions have names as in {one.form.title}, and {len(one.odd)} do not:{others}\n"
        f"Say how to read them: --format {one.form.name}, or --format {PLAIN.name} for {PLAIN.title}."
    )
