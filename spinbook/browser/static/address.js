// The addresses of the files that run nodes. Each names the version it belongs to, so that a page never mixes two.

// Replaced when the site is made: see spinbook/browser/files.py.
export const VERSION = "VERSION";

export const addressOf = (name) => new URL(`${name}?v=${VERSION}`, import.meta.url).href;
