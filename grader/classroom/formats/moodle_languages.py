"""Moodle's grading worksheet in other languages than English: its columns, and the names of months.

Source of the columns: Moodle's language packs (assign.php: recordid, status, maxgrade, gradecanbechanged,
lastmodifiedsubmission, lastmodifiedgrade; moodle.php: fullname, email, gradenoun; assignfeedback_comments.php:
pluginname), in the order of mod/assign/gradingtable.php. Source of the months: the Unicode CLDR.
"""

from __future__ import annotations

import re

#: The columns in English, in Moodle's order.
COLUMNS = (
    *("Identifier", "Full name", "Email address", "Status", "Grade", "Maximum Grade", "Grade can be changed"),
    *("Last modified (submission)", "Last modified (grade)", "Feedback comments"),
)
#: The column of a student's data with the language of the worksheet.
LANGUAGE = "Moodle's language"

_TRANSLATIONS = """
ca|Identificador|Nom complet|Adreça electrònica|Estat|Qualificació|Qualificació màxima|Es pot canviar la qualificació|Darrera modificació (tramesa)|Darrera modificació (qualificació)|Comentaris de retroacció.
de|ID|Vollständiger Name|E-Mail-Adresse|Status|Bewertung|Bestwertung|Bewertung kann geändert werden|Zuletzt geändert (Abgabe)|Zuletzt geändert (Bewertung)|Feedback als Kommentar
es|Identificador|Nombre completo|Dirección de correo|Estado|Calificación|Calificación máxima|La calificación puede ser cambiada|Última modificación (entrega)|Última modificación (calificación)|Comentarios de retroalimentación
fr|Identifiant|Nom complet|Adresse de courriel|Statut|Note|Note maximale|La note peut être modifiée|Dernière modification (travail remis)|Dernière modification (note)|Feedback par commentaires
it|Identificativo|Nome|Indirizzo email|Stato|Valutazione|Valutazione massima|La valutazione può essere cambiata|Ultima modifica (consegna)|Ultima modifica (valutazione)|Commenti
ja|ID|フルネーム|メールアドレス|ステータス|評点|最大評点|評点変更可|最終更新日時 (提出)|最終更新日時 (評定)|フィードバックコメント
nl|Identificatie|Volledige naam|E-mailadres|Status|Cijfer|Maximaal cijfer|Het cijfer kan gewijzigd worden|Laatst gewijzigd (inzending)|Laatst gewijzigd (beoordeling)|Feedback tekstvak
pt|Identificador|Nome completo|E-mail|Estado|Avaliação|Nota máxima|A nota pode ser alterada.|Última atualização (submissão)|Última atualização (avaliação)|Comentários de feedback
ru|Идентификатор|Полное имя|Адрес электронной почты|Статус|Оценка|Максимальная оценка|Оценка может быть изменена|Последнее изменение (ответ)|Последнее изменение (оценка)|Отзыв в виде комментария
sv|Identifierare|Fullständigt namn|E-postadress|Status|Betyg|Maxbetyg|Betyg kan ändras|Senast modifierat (inlämning)|Senast modifierat (betyg)|Återkopplingskommentarer
zh_cn|标识符|全名|电子邮件地址|状态|成绩|最高分|允许更改成绩|上次修改（作业）|上次修改（评分）|反馈意见
"""  # noqa: E501 - one line per language
LANGUAGES = {
    language: dict(zip(COLUMNS, columns, strict=True))
    for language, *columns in (line.split("|") for line in _TRANSLATIONS.strip().splitlines())
}

#: The first letters of the months, as few as tell them apart. Chinese and Japanese write numbers.
_MONTHS = {
    "ca": "gen feb març abr maig juny jul ag set oct nov des",
    "de": "jan feb mär apr mai jun jul aug sep okt nov dez",
    "es": "ene feb mar abr may jun jul ago sep oct nov dic",
    "fr": "jan fév mar avr mai juin juil ao sep oct nov déc",
    "it": "gen feb mar apr mag giu lug ago set ott nov dic",
    "nl": "jan feb maa apr mei jun jul aug sep okt nov dec",
    "pt": "jan fev mar abr mai jun jul ago set out nov dez",
    "ru": "янв фев мар апр ма июн июл авг сен окт ноя дек",
    "sv": "jan feb mar apr maj jun jul aug sep okt nov dec",
}
_WITH_NUMBERS = re.compile(r"(?P<year>\d{4}) ?年 ?(?P<month>\d\d?) ?月 ?(?P<day>\d\d?) ?日\D*(?P<clock>\d\d?:\d\d)")
_WITH_NAMES = re.compile(
    r"(?:[^\W\d]+,? )?(?P<day>\d\d?)\.? (?:de |d[’'])?(?P<month>[^\W\d]+)\.? (?:de )?(?P<year>\d{4})\D*"
    r"(?P<clock>\d\d?:\d\d)"
)


def in_english(row: dict[str, str]) -> dict[str, str]:
    """Return a row of a worksheet with its columns as in English, and `LANGUAGE`; any other row unchanged."""
    fitting = {language: sum(word in row for word in words.values()) for language, words in LANGUAGES.items()}
    language = max(fitting, key=lambda one: fitting[one])
    words = LANGUAGES[language]
    if words["Identifier"] not in row or fitting[language] < 4:
        return row
    names = {translated: english for english, translated in words.items()}
    return {**{names.get(name, name): value for name, value in row.items()}, LANGUAGE: language}


def time_in_english(text: str, language: str) -> str:
    """Return `Sonntag, 22. November 2026, 23:59` as 2026-11-22 23:59; another text unchanged."""
    match = _WITH_NUMBERS.fullmatch(text.strip()) or _WITH_NAMES.fullmatch(text.strip())
    if not match:
        return text
    month = match["month"].lower()
    beginnings = _MONTHS.get(language, "").split()
    number = (
        int(month)
        if month.isdecimal()
        else next((number for number, one in enumerate(beginnings, 1) if month.startswith(one)), 0)
    )
    return f"{match['year']}-{number:02}-{int(match['day']):02} {match['clock']:0>5}"
