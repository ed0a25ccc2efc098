// The address names the open exhibit: ?exhibit=…&lang=… can be handed on, Back closes it, Forward opens it again.
//
// An open exhibit is always one entry above the hall, also where somebody came by its link; leaving it goes back to
// that entry, so that a long visit does not fill the browser's history.

const ARRIVES_WITHIN = 500; // [ms] a step back is over by then, or something else has taken it

/** The exhibit the address names, null for the hall itself. */
export const linkedExhibit = () => new URLSearchParams(location.search).get("exhibit");

/** createAddress({lang, onWanted}) -> {follow(id | null)}; lang(): "zh" or "en"; onWanted(id | null): Back or Forward. */
export function createAddress({ lang, onWanted }) {
  let wanted = null, returning = 0;
  const above = () => history.state?.above === true;

  function naming(exhibit) {
    const url = new URL(location.href);
    if (exhibit === null) url.searchParams.delete("exhibit");
    else {
      url.searchParams.set("exhibit", exhibit);
      url.searchParams.set("lang", lang());
    }
    return url;
  }

  const standInHall = () => history.replaceState(null, "", naming(null));

  function settle() {
    if (returning) return;
    const named = linkedExhibit();
    if (wanted === null && named !== null) {
      if (!above()) standInHall();
      else {
        returning = setTimeout(returned, ARRIVES_WITHIN);
        history.back();
      }
    } else if (wanted !== null && !(named === wanted && above())) {
      if (named !== null && !above()) standInHall(); // somebody else's link: the hall goes beneath it
      history[above() ? "replaceState" : "pushState"]({ above: true }, "", naming(wanted));
    }
  }

  function returned() {
    clearTimeout(returning);
    returning = 0;
    if (linkedExhibit() !== null) standInHall(); // a frame's own history took the step
    settle();
  }

  addEventListener("popstate", () => {
    window.HALL.door.speak(lang()); // an older entry may name another language
    if (returning) {
      returned();
      return;
    }
    wanted = linkedExhibit();
    onWanted(wanted);
  });

  return {
    /** The exhibit that is open now, null in the hall. */
    follow(id) {
      wanted = id;
      settle();
    },
  };
}
