// In which order the site's search shows what it found, for Sphinx' searchtools.js: pages whose titles have the word,
// objects and the like, pages whose text has it, keys and options, of which many have the same name. Who writes an index
// or an address looks for just that; rows of requirements and sources have most words, and are seldom what is looked for.
const looked_for = (new URLSearchParams(window.location.search).get("q") || "").trim().toLowerCase();
const is_index = /^[0-9a-f]{4}h/.test(looked_for);

var Scorer = {
  score: ([page, title, , , score]) => {
    if (is_index && title.toLowerCase().startsWith(looked_for)) {
      return score + 100;
    }
    return /-requirements$|^repository\/.*\.\w+$/.test(page) ? score / 10 : score;
  },
  objNameMatch: 11,
  objPartialMatch: 1,
  objPrio: { 0: 9, 1: 0 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
