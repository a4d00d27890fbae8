# Tab completes presets, groups and keys:  source conf/completion.bash
# In zsh first: autoload -U bashcompinit && bashcompinit
# Hydra's own completion knows `python file.py`, not `python -m`.
_industnerf() {
  local word=${COMP_WORDS[COMP_CWORD]} choices="" rest
  if [[ ${COMP_WORDS[1]} == -m && ${COMP_WORDS[2]} == pipeline.* && $COMP_CWORD -gt 2 ]]; then
    case ${COMP_WORDS[2]} in
      pipeline.sweep)
        rest=${COMP_LINE#*pipeline.sweep}
        word=${rest##* }
        choices=$(COMP_LINE="sweep $rest" "${COMP_WORDS[0]}" -m pipeline.sweep -sc query=bash 2>/dev/null) ;;
      pipeline.preset)
        choices=$(cd conf/experiment && printf '%s\n' *.yaml | sed 's/\.yaml$//') ;;
    esac
  elif [[ ${COMP_WORDS[1]} == -m ]]; then
    choices="pipeline.sweep pipeline.preset pipeline.score pipeline.publish pipeline.grid pipeline.check"
    choices+=" industnerf.reconstruct industnerf.parts industnerf.doctor"
  fi
  COMPREPLY=($(compgen -W "$choices" -- "$word"))
}
# without `=` among the breaks, a whole `key=value` is one word
COMP_WORDBREAKS=${COMP_WORDBREAKS//=}
complete -o nospace -o default -F _industnerf python python3
