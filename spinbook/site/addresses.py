"""What tells search engines, feed readers and lost visitors what pages there are: sitemap, RSS, 404.

Forms: https://www.sitemaps.org/protocol.html and https://www.rssboard.org/rss-specification.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from spinbook.site.page import HOME, Page


def address_of(site: str, page: str) -> str:
    """Return a page's address; the home page's is the site's own."""
    return site if page == HOME else f"{site}{page}.html"


def address_files(site: str, title: str, pages: Sequence[Page]) -> dict[str, str]:
    """Return sitemap.xml, feed.xml, robots.txt and 404.html by name; nothing for a site whose address is not known."""
    if not site:
        return {}
    return {
        "sitemap.xml": _sitemap(site, pages),
        "feed.xml": _feed(site, title, pages),
        "robots.txt": f"User-agent: *\nAllow: /\nSitemap: {site}sitemap.xml\n",
        "404.html": _not_found(site, title),
    }


def _sitemap(site: str, pages: Sequence[Page]) -> str:
    urls = "".join(f"  <url><loc>{escape(address_of(site, page.name))}</loc></url>\n" for page in pages)
    head = '<?xml version="1.0" encoding="utf-8"?>\n<urlset xmlns="http://www.sitemaps.org/schemas/sitemap/0.9">\n'
    return f"{head}{urls}</urlset>\n"


def _feed(site: str, title: str, pages: Sequence[Page]) -> str:
    """The chapters and exercises, in reading order: a reader hears of each new one."""
    items = "".join(_item(site, page) for page in pages if page.kind in ("chapter", "exercise"))
    return (
        '<?xml version="1.0" encoding="utf-8"?>\n'
        '<rss version="2.0"><channel>\n'
        f"<title>{escape(title)}</title>\n<link>{escape(site)}</link>\n"
        f"<description>Chapters and exercises of {escape(title)}</description>\n"
        f"{items}</channel></rss>\n"
    )


def _item(site: str, page: Page) -> str:
    address = escape(address_of(site, page.name))
    summary = f"<description>{escape(page.summary)}</description>" if page.summary else ""
    return f"<item><title>{escape(page.title)}</title><link>{address}</link><guid>{address}</guid>{summary}</item>\n"


def _not_found(site: str, title: str) -> str:
    """A server shows it for any address, so that all its own addresses are whole."""
    base = escape(site)
    name = escape(title)
    links = f'<a href="{base}">{name}</a>, or <a href="{base}search.html">search the course</a>'
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'self'; "
        "style-src 'self'\">\n"
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n<meta name="robots" content="noindex">\n'
        f"<title>Page not found · {name}</title>\n"
        f'<link rel="stylesheet" href="{base}_static/site.css">\n</head>\n<body>\n'
        '<div class="frame"><main id="content">\n<h1>Page not found</h1>\n'
        f"<p>There is no page at this address. Chapters may have got another name: look at {links}.</p>\n"
        "</main></div>\n</body>\n</html>\n"
    )
