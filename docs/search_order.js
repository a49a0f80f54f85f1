/* How-to pages first, then tutorials and explanations; what is looked up follows, the archive comes last.
   The numbers beside `score` are Sphinx's own: a page that a word is in has 5, an object of that name 26. */
"use strict";
var Scorer = {
  score: (result) => {
    const [docname, , , , score] = result;
    const folders = { "how-to": 40, tutorial: 35, explanation: 30, reference: 5, archive: -20 };
    const api = docname.startsWith("reference/api") ? -10 : 0;
    return score + api + (folders[docname.split("/")[0]] || 0);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
